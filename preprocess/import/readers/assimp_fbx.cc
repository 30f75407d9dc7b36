/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds models and values in an FBX file that Assimp silently omits, duplicates or misreads. */
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <set>
#include <string_view>
#include <vector>

#include "preprocess/import/readers/assimp_losses.hh"
#include "preprocess/import/readers/reader.hh"

/* Returns the name that ends at `end` in a binary FBX file. In the file, "S" and a four-byte length precede the name. */
static std::string name_before(const std::string &bytes, size_t end)
{
    constexpr size_t MAX_NAME = 512, HEAD = 5;
    for (size_t length = 0; length < MAX_NAME && length + HEAD <= end; length++) {
        const char *head = bytes.data() + end - length - HEAD;
        uint32_t said;
        memcpy(&said, head + 1, sizeof(said));
        /* the length in the file also counts two control characters and the class name "Model", which follow the name */
        if (*head == 'S' && said == length + strlen("??Model"))
            return bytes.substr(end - length, length);
    }
    return "";
}

static void say_fbx(const std::string &name)
{
    printf("lost\t\t%s\tmodel\t\tPlantcast does not read NURBS and patches, so this part is not shown: export the model as polygons\n",
           one_line(name).c_str());
}

void assimp_losses_of_fbx(const std::string &bytes)
{
    static const char *const kinds[] = { "NurbsSurface", "TrimNurbsSurface", "Nurb", "Patch" };
    for (const char *kind : kinds) {
        const std::string quoted = std::string("\", \"") + kind + "\"";
        for (size_t at = 0; (at = bytes.find(quoted, at)) != std::string::npos; at += quoted.size()) {
            const size_t line = bytes.rfind('\n', at) + 1, name = bytes.find("\"Model::", line);
            if (name < at)
                say_fbx(bytes.substr(name + strlen("\"Model::"), at - name - strlen("\"Model::")));
        }
        const char length[4] = { static_cast<char>(strlen(kind)), 0, 0, 0 };
        const std::string binary = std::string("\0\1ModelS", 8) + std::string(length, sizeof(length)) + kind;
        for (size_t at = 0; (at = bytes.find(binary, at)) != std::string::npos; at += binary.size())
            say_fbx(name_before(bytes, at));
    }
}

namespace
{

constexpr const char *SCENE = "0"; /* id of the scene's root node in an FBX file's connections */

/* The models of an FBX file in text form, and the connections between them. Keys are FBX ids. */
struct fbx_graph {
    std::map<std::string, std::string> models; /* names of the FBX models, by id */
    std::set<std::string> geometries, shown;   /* ids of geometries; ids of models that have a geometry and are therefore visible */
    std::multimap<std::string, std::string> children;
    std::map<std::string, size_t> parents; /* number of parents of each FBX model, by id */
};

/* Returns the part of a line between two marks; if the second is missing, up to the end. Returns "" if the first is missing. */
std::string between(std::string_view line, const char *first, char second)
{
    const size_t at = line.find(first), from = at + strlen(first);
    return at == line.npos ? "" : std::string(line.substr(from, line.find(second, from) - from));
}

void add_link(fbx_graph *graph, std::string_view line)
{
    const std::string child = between(line, "\"OO\",", ',');
    std::string parent = between(line, (child + ",").c_str(), ',');
    parent.erase(std::find_if(parent.begin(), parent.end(), [](unsigned char c) { return c < '0'; }), parent.end());
    if (graph->geometries.count(child) > 0)
        graph->shown.insert(parent);
    if (graph->models.count(child) == 0 || (parent != SCENE && graph->models.count(parent) == 0))
        return;
    graph->children.insert({ parent, child });
    graph->parents[child]++;
}

/* Overwrites an earlier statement of the property in `line` with blanks: the last statement is the valid one, but Assimp
   takes the first. at: position of the line in the text. known: position of each property of the
   current list, by name. */
void keep_last(std::string *text, size_t at, std::string_view line, std::map<std::string, size_t> *known, const std::string &owner,
               bool say)
{
    const std::string name = between(line, "P: \"", '"');
    auto [first, added] = known->insert({ name, at });
    if (added || line.back() == '{')
        return;
    for (size_t i = first->second; i < text->size() && (*text)[i] != '\n'; i++)
        (*text)[i] = ' ';
    first->second = at;
    if (say)
        printf("error\t1\tin the FBX file, %s property %s more than once: the last value is used\n", owner.c_str(), one_line(name).c_str());
}

void say_graph(const fbx_graph &graph)
{
    std::set<std::string> reached = { SCENE };
    for (std::vector<std::string> open = { SCENE }; !open.empty();) {
        auto [from, to] = graph.children.equal_range(open.back());
        open.pop_back();
        for (; from != to; from++)
            if (reached.insert(from->second).second)
                open.push_back(from->second);
    }
    for (const auto &[id, name] : graph.models) {
        auto parents = graph.parents.find(id);
        if (graph.shown.count(id) > 0 && reached.count(id) == 0)
            printf("lost\t%s\t%s\tmodel\t\tthis part is not shown, because the FBX file does not connect it with the scene\n", id.c_str(),
                   name.c_str());
        else if (parents != graph.parents.end() && parents->second > 1)
            printf("error\t1\tFBX part %s has %zu parents: the part is shown below each parent\n", name.c_str(), parents->second);
    }
}

} // namespace

void assimp_mend_fbx(std::string *text, bool say)
{
    fbx_graph graph;
    std::map<std::string, size_t> known;
    std::string owner = "the defaults state";
    for (size_t at = 0, next; at < text->size(); at = next + 1) {
        next = std::min(text->find('\n', at), text->size());
        const size_t begin = std::min(text->find_first_not_of(" \t", at), next);
        const std::string_view line = std::string_view(*text).substr(begin, next - begin);
        auto is = [line](const char *word) { return line.compare(0, strlen(word), word) == 0; };
        if (is("Model: ")) {
            const std::string name = one_line(between(line, "\"Model::", '"'));
            owner = "model " + name + " states";
            graph.models[between(line, "Model: ", ',')] = name;
        } else if (is("Geometry: ")) {
            graph.geometries.insert(between(line, "Geometry: ", ','));
        } else if (is("Properties70:")) {
            known.clear();
        } else if (is("P: \"")) {
            keep_last(text, begin, line, &known, owner, say);
        } else if (is("C: \"OO\",")) {
            add_link(&graph, line);
        }
    }
    if (say)
        say_graph(graph);
}
