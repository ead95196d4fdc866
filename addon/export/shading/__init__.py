# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials, images, lights and the world as records of the snapshot."""
