# SPDX-License-Identifier: GPL-3.0-or-later
"""The demo's textures, made by NumPy: images of Blender with linear or sRGB float pixels."""

import bpy
import numpy as np


def value_noise(height: int, width: int, cells_y: int, cells_x: int, seed: int) -> np.ndarray:
    """[height, width] in 0..1: random values on a periodic lattice, smoothly interpolated."""
    lattice = np.random.default_rng(seed).random((cells_y, cells_x))

    def weights(size: int, cells: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        place = np.arange(size) * cells / size
        low = place.astype(int)
        fraction = place - low
        return low, (low + 1) % cells, fraction * fraction * (3 - 2 * fraction)

    y0, y1, fy = weights(height, cells_y)
    x0, x1, fx = weights(width, cells_x)
    upper = lattice[np.ix_(y0, x0)] * (1 - fx) + lattice[np.ix_(y0, x1)] * fx
    lower = lattice[np.ix_(y1, x0)] * (1 - fx) + lattice[np.ix_(y1, x1)] * fx
    return upper * (1 - fy)[:, None] + lower * fy[:, None]


def fractal_noise(height: int, width: int, cells_y: int, cells_x: int, seed: int) -> np.ndarray:
    """[height, width] around 0..1: five octaves of value noise."""
    total = np.zeros((height, width))
    for octave in range(5):
        total += value_noise(height, width, cells_y << octave, cells_x << octave, seed + octave) / (
            2 << octave
        )
    return total / (1 - 1 / 32)


def wood(height: int, width: int, dark: tuple, light: tuple, seed: int) -> np.ndarray:
    """[height, width, 3] sRGB: grain along x, between two colours."""
    warp = fractal_noise(height, width, 3, 2, seed)
    rings = 0.5 + 0.5 * np.sin(2 * np.pi * (warp * 5 + np.linspace(0, 3, height)[:, None]))
    fibre = fractal_noise(height, width, min(height // 32, 64), 4, seed + 50)
    mix = np.clip(0.55 * rings + 0.75 * (fibre - 0.5) + 0.15, 0, 1)[..., None]
    return np.asarray(dark) * (1 - mix) + np.asarray(light) * mix


def chessboard(squares: int, square_px: int) -> np.ndarray:
    """[n, n, 3] sRGB: inlaid squares of two woods, every one cut from another place."""
    boxwood = wood(1024, 1024, (0.66, 0.47, 0.29), (0.87, 0.70, 0.48), 1)
    rosewood = wood(1024, 1024, (0.14, 0.06, 0.04), (0.36, 0.17, 0.10), 2)
    board = np.zeros((squares * square_px, squares * square_px, 3))
    place = np.random.default_rng(3)
    inset = max(square_px // 64, 1)
    for row in range(squares):
        for column in range(squares):
            y, x = place.integers(0, 1024 - square_px, 2)
            cut = (boxwood if (row + column) % 2 else rosewood)[
                y : y + square_px, x : x + square_px
            ]
            cut = cut * place.uniform(0.86, 1.08)
            if place.random() < 0.5:
                cut = cut[::-1]
            # The joint between two squares is a thin dark line.
            for edge in (np.s_[:inset], np.s_[-inset:]):
                cut[edge] *= 0.55
                cut[:, edge] *= 0.55
            tile = np.s_[
                row * square_px : (row + 1) * square_px,
                column * square_px : (column + 1) * square_px,
            ]
            board[tile] = cut
    return np.clip(board, 0, 1)


def patches(size: int) -> np.ndarray:
    """[size, size, 3] sRGB: a cow's dark patches on cream."""
    noise = fractal_noise(size, size, 5, 5, 11)
    edge = np.clip((noise - 0.5) * 60, 0, 1)[..., None]
    return np.array((0.93, 0.90, 0.83)) * (1 - edge) + np.array((0.16, 0.10, 0.08)) * edge


def image(name: str, rgb: np.ndarray) -> bpy.types.Image:
    """A packed Blender image of sRGB values [height, width, 3], row 0 at the bottom."""
    height, width = rgb.shape[:2]
    result = bpy.data.images.new(name, width, height)
    rgba = np.ones((height, width, 4), np.float32)
    rgba[..., :3] = rgb
    result.pixels.foreach_set(rgba.ravel())
    result.pack()
    return result
