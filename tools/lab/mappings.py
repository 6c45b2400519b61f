"""Mappings that follow from the number of PEs."""


def squarest_grid(pes):
    """(A, B): A rows of B PEs, A the largest divisor of P up to its root."""
    rows = max(a for a in range(1, int(pes**0.5) + 1) if pes % a == 0)
    return rows, pes // rows
