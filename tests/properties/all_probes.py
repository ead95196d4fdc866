# SPDX-License-Identifier: GPL-3.0-or-later
"""All probes of this Blender."""

import probe_geometry
import probe_images
import probe_lights
import probe_nodes
import probe_objects
import probe_particles
import probe_scenes


def all_probes():
    return [
        *probe_scenes.PROBES,
        *probe_lights.PROBES,
        *probe_objects.PROBES,
        *probe_geometry.probes(),
        *probe_particles.PROBES,
        *probe_images.PROBES,
        *probe_nodes.probes(),
    ]
