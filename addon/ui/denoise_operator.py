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
        return hasattr(context.view_layer, "cycles")  # whose Denoising Data asks for the passes

    def execute(self, context):
        scene = context.scene
        tree = _compositor(scene)
        layers = [node for node in tree.nodes if node.bl_idname == _LAYERS and node.scene == scene]
        added = sum(_denoise(tree, node) for node in layers)
        self.report({"INFO"}, f"{added} of {len(layers)} render layers are denoised anew")
        return {"FINISHED"}


def _compositor(scene):
    """The scene's tree, made where there is none: render layers that go to the output."""
    if not hasattr(scene, "compositing_node_group"):
        scene.use_nodes = True
        return scene.node_tree
    scene.render.use_compositing = True
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
    """Whether a Denoise node was put between a node of render layers and what takes its image."""
    image = layers.outputs["Image"]
    taken = [link.to_socket for link in image.links]
    if any(socket.node.bl_idname == _NODE for socket in taken):
        return False
    layer = layers.scene.view_layers[layers.layer]
    layer.cycles.denoising_store_passes = True
    layer.update_render_passes()
    node = tree.nodes.new(_NODE)
    node.location = layers.location.x + 300, layers.location.y
    tree.links.new(image, node.inputs["Image"])
    for name, source in _GUIDES.items():
        tree.links.new(layers.outputs[source], node.inputs[name])
    for socket in taken:
        tree.links.new(node.outputs["Image"], socket)
    return True


register, unregister = bpy.utils.register_classes_factory((GRANITA_OT_denoise,))
