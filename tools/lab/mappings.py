"""Mappings that follow from the number of PEs, and the lattice of pixels that one PE owns.

The lattice is that of the cyclic mapping with a PE for each column: (p, 1) and (W, 0).
"""


def squarest_grid(pes):
    """(A, B): A rows of B PEs, A the largest divisor of P up to its root."""
    rows = max(a for a in range(1, int(pes**0.5) + 1) if pes % a == 0)
    return rows, pes // rows


def shortest_square(offset, side):
    """The square of the length of its shortest vector, pixels."""
    least = side * side
    rows = 1
    while rows * rows < least:
        right = rows * offset % side
        least = min(least, rows * rows + min(right, side - right) ** 2)
        rows += 1
    return least


def shortest_vector(offset, side):
    return shortest_square(offset, side) ** 0.5


def shares_blocks(offset, side, n):
    """Whether no PE owns two pixels of any n x n block."""
    return n <= side and all(min(rows * offset % side, side - rows * offset % side) >= n for rows in range(1, n))
