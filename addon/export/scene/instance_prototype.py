# SPDX-License-Identifier: GPL-3.0-or-later
"""What instances share that differ in their place alone."""

from dataclasses import dataclass, field

from ..geometry.subdivision import Cage


def hidden_owners(owners):
    """InstancePrototype.hidden of evaluated objects."""
    return frozenset(owner.original.as_pointer() for owner in owners if owner.hide_render)


@dataclass
class InstancePrototype:
    """One object as it is placed by itself, or by one instancer.

    The references live until time is moved; then `forget` them.
    """

    type: str  # "MESH", "CURVES", "POINTCLOUD", "HAIR" or "LIGHT"
    name: str
    source: object  # evaluated Object
    parent: object  # evaluated Object that instances it, or None
    data: object = None  # evaluated Mesh, Curves or PointCloud; None for a cage, hair and lights
    cage: Cage = None
    system: str = ""  # the particle system of hair
    # Of the visit at the frame alone:
    materials: list = field(default_factory=list)  # evaluated Material or None, one a slot
    material_addresses: tuple = ()  # of their originals, 0 = none
    address: int = 0  # of the original Object
    parent_address: int = 0  # of what instances it; 0 = nothing
    takes_place_on_instancer: bool = False
    culling_box: object = None  # of culling.culling_box, where the scene leaves things out by it
    blurs: bool = True
    fewest_segments: int = 1
    unbaked: tuple = ()  # of simulations.unbaked: (object's name, simulation)
    hidden: frozenset = frozenset()  # addresses of those of the two that are hidden in renders

    @property
    def label(self):
        """Name of the geometry for messages."""
        original = self.source.original
        if self.type == "HAIR":
            return f"particle system '{self.system}' of object '{original.name}'"
        if original.type == "MESH" and self.type == "MESH":
            return f"mesh '{original.data.name}'"
        return f"object '{original.name}'"

    def owners(self, everything, depsgraph):
        """Its object and what instances it, evaluated; None where a handler of another add-on deleted one.

        Args:
            everything: of changes.originals.
        """
        addresses = [address for address in (self.address, self.parent_address) if address]
        if not all(address in everything for address in addresses):
            return None
        return [everything[address].evaluated_get(depsgraph) for address in addresses]

    def is_hidden_now(self, owners):
        """Whether one of its two evaluated objects is hidden, at another time, that was not when it was seen.
        (Nodes make instances of hidden objects.)"""
        return any(o.hide_render and o.original.as_pointer() not in self.hidden for o in owners)

    def forget(self):
        """Lets go of everything that dies when time is moved."""
        self.source = self.parent = self.data = None
        self.materials = []

    def geometry_key(self):
        """Equal for prototypes that have one geometry."""
        if self.type == "HAIR":
            return self.source.as_pointer(), self.system
        if self.cage is None:
            return self.data.as_pointer()
        return self.cage.sharing or (self.source.as_pointer(), "CAGE")
