# SPDX-License-Identifier: GPL-3.0-or-later
"""Open Image Denoise behind what a scene renders: Blender's own node, in the compositor."""

import bpy

_NODE = "CompositorNodeDenoise"
_LAYERS = "CompositorNodeRLayers"
# The node's inputs, and the passes of Denoising Data that they read.
_GUIDES = {"Normal": "Denoising Normal", "Albedo": "Denoising Albedo"}


class GRANITA_OT_denoise(bpy.types.Operator):
    """Put Blender's Denoise node behind the scene's render layers in the compositor, with the passes that it reads"""

    bl_idname = "scene.granita_denoise"
    bl_label = "Set Up Denoising"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        # Cycles' add-on has the setting that asks for the passes.
        return context.engine == "GRANITA" and hasattr(context.view_layer, "cycles")

    def execute(self, context):
        scene = context.scene
        tree = _compositor(scene)
        if tree.library is not None:
            self.report(
                {"ERROR"}, f"'{tree.name}' belongs to another file: its nodes cannot change"
            )
            return {"CANCELLED"}
        layers = [node for node in tree.nodes if node.bl_idname == _LAYERS and node.scene == scene]
        added = sum(_denoise(tree, node) for node in layers)
        self.report({"INFO"}, f"{added} of {len(layers)} render layers are denoised anew")
        return {"FINISHED"}


def _compositor(scene):
    """The scene's tree, made where there is none: render layers that go to the output."""
    scene.render.use_compositing = True
    if not hasattr(scene, "compositing_node_group"):
        scene.use_nodes = True
        return scene.node_tree
    if scene.compositing_node_group is None:
        tree = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
        layers, out = tree.nodes.new(_LAYERS), tree.nodes.new("NodeGroupOutput")
        layers.scene = scene
        out.location.x = layers.location.x + 600
        tree.links.new(layers.outputs["Image"], out.inputs[0])
        scene.compositing_node_group = tree
    return scene.compositing_node_group


def _denoise(tree, layers):
    """Whether the image of a node of render layers was not denoised and is now.  A Denoise node that is there already
    gets what it has not."""
    layer = layers.scene.view_layers.get(layers.layer)
    if layer is None:
        return False
    layer.cycles.denoising_store_passes = True
    layer.update_render_passes()
    image = layers.outputs["Image"]
    taken = [link.to_socket for link in image.links]
    node = next((socket.node for socket in taken if socket.node.bl_idname == _NODE), None)
    is_new = node is None
    if is_new:
        node = tree.nodes.new(_NODE)
        node.location = layers.location.x + 300, layers.location.y
        tree.links.new(image, node.inputs["Image"])
        for socket in taken:
            tree.links.new(node.outputs["Image"], socket)
    was_off, node.mute = node.mute, False
    for name, source in _GUIDES.items():
        if not node.inputs[name].is_linked:
            tree.links.new(layers.outputs[source], node.inputs[name])
    return is_new or was_off


register, unregister = bpy.utils.register_classes_factory((GRANITA_OT_denoise,))
