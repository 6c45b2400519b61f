"""The 2-D grid mapping that is nearest to a square, and the lattice that the pixels of one PE form.

With the cyclic mapping and a PE for each column, the pixels of a PE form a lattice with the basis (p, 1) and (W, 0), in (columns, rows), for an
offset p and an image of W columns.
"""
import numpy as np


def squarest_grid(pes):
    """Returns (A, B): A rows of B PEs, where A is the largest divisor of `pes` that is at most sqrt(pes)."""
    rows = max(a for a in range(1, int(pes**0.5) + 1) if pes % a == 0)
    return rows, pes // rows


def shortest_square(offset, side):
    """Returns the squared length of the lattice's shortest vector, in pixels squared."""
    rows = np.arange(1, side + 1)  # after `side` rows a slot is back in its first column
    right = rows * offset % side
    return int((rows**2 + np.minimum(right, side - right)**2).min())


def shares_blocks(offset, side, n):
    """Returns true if no PE owns two or more pixels of an n x n block, wherever the block lies in the image."""
    return n <= side and all(min(rows * offset % side, side - rows * offset % side) >= n for rows in range(1, n))
