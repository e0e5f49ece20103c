# SPDX-License-Identifier: GPL-3.0-or-later
"""Node trees in few words, above all what came with Blender 5: zones, closures, bundles."""

from __future__ import annotations

import bpy
from wardmis import compat

SOCKETS = {"FLOAT": "Float", "RGBA": "Color", "VECTOR": "Vector", "SHADER": "Shader", "INT": "Int", "BOOLEAN": "Bool"}
SOCKETS |= {"CLOSURE": "Closure", "BUNDLE": "Bundle", "MENU": "Menu"}


class Tree:
    """A node tree in the making, in few words: of a node `node.outputs` are returned by name, a value is a constant or a socket."""

    def __init__(self, tree):
        self.tree = tree

    def feed(self, socket, value):
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif value is not None:
            socket.default_value = value

    def node(self, kind, *inputs, **settings):
        """`inputs`: of the sockets in use, in turn; None: left as it is."""
        node = self.tree.nodes.new(kind)
        for name, value in settings.items():
            setattr(node, name, value)
        for socket, value in zip((s for s in node.inputs if s.enabled), inputs):
            self.feed(socket, value)
        return node

    def math(self, operation, *inputs):
        return self.node("ShaderNodeMath", *inputs, operation=operation).outputs[0]

    def path(self, name="Ray Length"):
        """A number that is not known before something is rendered."""
        return self.node("ShaderNodeLightPath").outputs[name]

    def pair(self, start, end):
        start, end = self.tree.nodes.new(start), self.tree.nodes.new(end)
        start.pair_with_output(end)
        return start, end

    def repeat(self, items, iterations, *given):
        """A repeat zone's two nodes."""
        start, end = self.pair("GeometryNodeRepeatInput", "GeometryNodeRepeatOutput")
        end.repeat_items.clear()
        for item in items:
            end.repeat_items.new(*item)
        for socket, value in zip(start.inputs, (iterations, *given)):
            self.feed(socket, value)
        return start, end

    def closure(self, inputs, outputs):
        start, end = self.pair("NodeClosureInput", "NodeClosureOutput")
        for item in inputs:
            end.input_items.new(*item)
        for item in outputs:
            end.output_items.new(*item)
        return start, end

    def evaluate(self, closure, inputs, outputs, *given):
        node = self.tree.nodes.new("NodeEvaluateClosure")
        for item in inputs:
            node.input_items.new(*item)
        for item in outputs:
            node.output_items.new(*item)
        for socket, value in zip(node.inputs, (closure, *given)):
            self.feed(socket, value)
        return node.outputs

    def bundle(self, items, *given):
        node = self.tree.nodes.new("NodeCombineBundle")
        for item in items:
            node.bundle_items.new(*item)
        for socket, value in zip(node.inputs, given):
            self.feed(socket, value)
        return node.outputs[0]

    def separate(self, bundle, items):
        node = self.tree.nodes.new("NodeSeparateBundle")
        for item in items:
            node.bundle_items.new(*item)
        self.feed(node.inputs[0], bundle)
        return node.outputs

    def group(self, inputs, outputs):
        """A new node group, its Tree, and the sockets inside: what enters, what leaves."""
        tree = bpy.data.node_groups.new("Group", "ShaderNodeTree")
        for direction, sockets in (("INPUT", inputs), ("OUTPUT", outputs)):
            for kind, name in sockets:
                compat.add_group_socket(tree, name, f"NodeSocket{SOCKETS[kind]}", direction)
        inside = Tree(tree)
        return inside, inside.node("NodeGroupInput").outputs, inside.node("NodeGroupOutput").inputs

    def use(self, group, *inputs):
        return self.node("ShaderNodeGroup", *inputs, node_tree=group.tree).outputs
