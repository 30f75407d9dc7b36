/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the nodes of the default scene, depth first, with world transforms; each instance of EXT_mesh_gpu_instancing becomes a separate
 * node. */
#include "preprocess/model/gltf_impl.hh"

#include <algorithm>
#include <cmath>

extern "C" {
#include "plant/models/node_rules.h"
#include "plant/models/transform.h"
}

namespace gltf
{
namespace
{

constexpr uint32_t ELEMENTS_PER_INSTANCE = 16;
/* tolerance for a quaternion's length; instance rotations stored as bytes deviate by up to 0.008 */
constexpr double ROTATION_SLACK = 0.01;

/* If a rule of node_rules.h failed for the node `what`, throws an exception with the rule's result `why`. NULL: it did not fail. */
void check(const char *why, const std::string &what)
{
    if (why)
        refuse("%s: %s", what.c_str(), why);
}

/* Computes the transform of a node or an instance. glTF requires rotations to be unit quaternions; a quaternion of another
 * length is normalised, as in other programs, and counted, unless the difference is only rounding. matrix: replaces the other
 * three; nullptr: none. */
void compose(gltf_work *w, const double t[3], const double q[4], const double s[3], const double *matrix, double out[16],
             const std::string &what)
{
    check(node_rules_local(t, q, s, matrix, out), what);
    double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    w->model->scaled_rotations += std::fabs(length - 1) > ROTATION_SLACK;
}

void take(const std::vector<double> &from, size_t count, double *to)
{
    for (size_t i = 0; i < count && i < from.size(); i++)
        to[i] = from[i];
}

void local_of(gltf_work *w, const tinygltf::Node &node, double out[16], const std::string &what)
{
    double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 };
    take(node.translation, 3, t);
    take(node.rotation, 4, q);
    take(node.scale, 3, s);
    compose(w, t, q, s, node.matrix.size() == 16 ? node.matrix.data() : nullptr, out, what);
}

struct node_order { /* working data for listing the scene's nodes in depth-first order */
    gltf_work *w;
    std::vector<gltf_node> out;
    std::vector<char> seen;
};

std::string node_what(const tinygltf::Model &m, int number)
{
    const std::string &name = m.nodes.at(static_cast<size_t>(number)).name;
    return "node " + std::to_string(number) + (name.empty() ? "" : " '" + name.substr(0, 80) + "'");
}

void add(node_order *tree, int number, int parent, int mesh, const double world[16])
{
    const std::string &name = tree->w->parsed.nodes[static_cast<size_t>(number)].name;
    if (tree->out.size() >= NODE_MAX_COUNT)
        refuse("more than %d nodes", NODE_MAX_COUNT);
    gltf_node node = {};
    node.parent = parent;
    node.mesh = mesh;
    node.number = static_cast<uint32_t>(number);
    memcpy(node.world, world, sizeof(node.world));
    tree->out.push_back(node);
    tree->out.back().name = mem_strdup(name.c_str());
    tree->out.back().end = static_cast<uint32_t>(tree->out.size());
}

/* Adds the mesh of a node with EXT_mesh_gpu_instancing once per instance, as child nodes with the same name. */
void add_instances(node_order *tree, int number, int parent, const tinygltf::Value &extension)
{
    const tinygltf::Node &node = tree->w->parsed.nodes[static_cast<size_t>(number)];
    std::string what = node_what(tree->w->parsed, number) + ": EXT_mesh_gpu_instancing";
    const tinygltf::Value none, &attributes = extension.IsObject() && extension.Has("attributes") ? extension.Get("attributes") : none;
    const char *const names[3] = { "TRANSLATION", "ROTATION", "SCALE" };
    const int widths[3] = { 3, 4, 3 };
    std::vector<accessor> values;
    int used[3] = { -1, -1, -1 };
    for (int i = 0; i < 3; i++) {
        double place = number_in(attributes, names[i], 0, -1);
        if (place < 0)
            continue;
        used[i] = static_cast<int>(values.size());
        values.emplace_back(*tree->w, static_cast<int>(place), widths[i], what + ": " + names[i]);
        if (values.back().count() != values.front().count())
            refuse("invalid glTF file: %s: the attributes have different numbers of instances, %zu and %zu", what.c_str(),
                   values.front().count(), values.back().count());
    }
    if (values.empty())
        refuse("invalid glTF file: %s: the instances have neither TRANSLATION, ROTATION nor SCALE", what.c_str());
    take_elements(tree->w, values.front().count() * ELEMENTS_PER_INSTANCE, what);
    for (size_t i = 0; i < values.front().count(); i++) {
        double t[3] = { 0, 0, 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, local[16], world[16];
        double *const parts[3] = { t, q, s };
        for (int p = 0; p < 3; p++)
            if (used[p] >= 0)
                values[static_cast<size_t>(used[p])].get(i, parts[p]);
        compose(tree->w, t, q, s, nullptr, local, what);
        transform_multiply(tree->out[static_cast<size_t>(parent)].world, local, world);
        check(node_rules_world(world), what);
        add(tree, number, parent, node.mesh, world);
    }
}

void walk(node_order *tree, int number, int parent, const double parent_world[16], uint32_t depth)
{
    std::string what = node_what(tree->w->parsed, number);
    if (tree->seen[static_cast<size_t>(number)])
        refuse("invalid glTF file: %s is part of a cycle or has two parents", what.c_str());
    if (depth > NODE_MAX_DEPTH)
        refuse("%s of the glTF model is nested deeper than %d levels, the most that Plantcast supports", what.c_str(), NODE_MAX_DEPTH);
    tree->seen[static_cast<size_t>(number)] = 1;
    const tinygltf::Node &node = tree->w->parsed.nodes[static_cast<size_t>(number)];
    bool morphs = std::any_of(node.weights.begin(), node.weights.end(), [](double weight) { return weight != 0; });
    check(node_rules_shape(node.mesh >= 0, node.skin >= 0, morphs), what);
    double local[16], world[16];
    local_of(tree->w, node, local, what);
    transform_multiply(parent_world, local, world);
    check(node_rules_world(world), what);
    int self = static_cast<int>(tree->out.size());
    auto instancing = node.extensions.find("EXT_mesh_gpu_instancing");
    bool instanced = instancing != node.extensions.end() && node.mesh >= 0;
    add(tree, number, parent, instanced ? -1 : node.mesh, world);
    if (instanced)
        add_instances(tree, number, self, instancing->second);
    for (int child : node.children)
        walk(tree, child, self, world, depth + 1);
    tree->out[static_cast<size_t>(self)].end = static_cast<uint32_t>(tree->out.size());
}

std::vector<int> roots_of(const tinygltf::Model &m)
{
    if (!m.scenes.empty())
        return m.scenes.at(m.defaultScene >= 0 ? static_cast<size_t>(m.defaultScene) : 0).nodes;
    std::vector<char> child(m.nodes.size(), 0);
    for (const tinygltf::Node &node : m.nodes)
        for (int c : node.children)
            child.at(static_cast<size_t>(c)) = 1;
    std::vector<int> roots;
    for (size_t i = 0; i < m.nodes.size(); i++)
        if (!child[i])
            roots.push_back(static_cast<int>(i));
    if (roots.empty() && !m.nodes.empty())
        refuse("invalid glTF file: every node is the child of another node: the nodes form a cycle");
    return roots;
}

/* Appends the number of nodes with a mesh outside the default scene to the model's left_out. */
void note_unreached(const node_order &tree)
{
    size_t count = 0;
    std::string first;
    for (size_t i = 0; i < tree.seen.size(); i++)
        if (!tree.seen[i] && tree.w->parsed.nodes[i].mesh >= 0 && count++ == 0)
            first = node_what(tree.w->parsed, static_cast<int>(i));
    if (count > 0)
        leave_out(tree.w, "not shown, because not in the glTF file's default scene: " + std::to_string(count) +
                              (count > 1 ? " nodes with meshes, such as " : " node with a mesh, ") + first);
}

} // namespace

void read_nodes(gltf_work *w)
{
    static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
    node_order tree = { w, {}, std::vector<char>(w->parsed.nodes.size(), 0) };
    try {
        for (int root : roots_of(w->parsed))
            walk(&tree, root, -1, identity, 0);
        note_unreached(tree);
        w->model->nodes = new_array<gltf_node>(tree.out.size() + 1);
    } catch (...) {
        for (gltf_node &node : tree.out)
            mem_free(node.name);
        throw;
    }
    w->model->node_count = static_cast<uint32_t>(tree.out.size());
    if (!tree.out.empty())
        memcpy(w->model->nodes, tree.out.data(), tree.out.size() * sizeof(gltf_node));
}

} // namespace gltf
