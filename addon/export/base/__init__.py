# SPDX-License-Identifier: GPL-3.0-or-later
"""What all rooms share: reports, the snapshot, transforms, identities, what an evaluation touched."""
