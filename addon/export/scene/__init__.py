# SPDX-License-Identifier: GPL-3.0-or-later
"""What is in the scene at the frame: one walk over the depsgraph, camera, options, persistent state."""
