# SPDX-License-Identifier: GPL-3.0-or-later
"""What panels of the properties editor share that are there for Granita alone."""


class EnginePanel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {"GRANITA"}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def column(self, heading="", align=False):
        """Of properties that stand beside their names and are not animated here."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout.column(heading=heading, align=align)
