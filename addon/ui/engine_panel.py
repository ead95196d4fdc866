# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels of the properties editor share that are there for Granita alone."""


class EnginePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {"GRANITA"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES
