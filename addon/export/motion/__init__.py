# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves within the shutter, and between adjacent frames."""
