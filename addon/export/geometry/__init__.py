# SPDX-License-Identifier: GPL-3.0-or-later
"""Evaluated meshes, curves, hair and points as arrays."""
