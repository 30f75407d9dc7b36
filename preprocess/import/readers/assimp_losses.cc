/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds shapes that Assimp skips without a message, by searching the text of the model file for keywords of such shapes. */
#include "preprocess/import/readers/assimp_losses.hh"
#include "preprocess/import/readers/reader.hh"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstring>

namespace
{

constexpr const char *LOSSES[] = { "ignoring unrecognized geometry", "ignoring empty geometry",    "skipping null geometry",
                                   "incoming Model link, ignoring",  "ither Material, NodeAttribute", "Unable to find geometry",
                                   "Vertex index overflow" };

/* Returns the value of an attribute of an XML tag; "" if the tag has no such attribute. */
std::string attribute(const std::string &tag, const std::string &name)
{
    const size_t from = tag.find(" " + name + "=");
    if (from == std::string::npos || from + name.size() + 2 >= tag.size())
        return "";
    const size_t start = from + name.size() + 3, end = tag.find(tag[start - 1], start);
    return end == std::string::npos ? "" : one_line(tag.substr(start, end - start));
}

bool has_any(const std::string &text, size_t from, size_t to, const std::initializer_list<const char *> &words)
{
    return std::any_of(words.begin(), words.end(), [&](const char *word) {
        const std::string_view part = std::string_view(text).substr(from, to - from);
        return part.find(word) != std::string_view::npos;
    });
}

} // namespace

void assimp_log::write(const char *message)
{
    std::string text = one_line(message);
    while (!text.empty() && isspace(static_cast<unsigned char>(text.back())))
        text.pop_back();
    const bool lost = std::any_of(std::begin(LOSSES), std::end(LOSSES), [&](const char *loss) { return text.find(loss) != text.npos; });
    if (text.compare(0, 4, "Warn") == 0 && !lost)
        return;
    const size_t place = text.find(" (TOK_"), end = place == text.npos ? place : text.find(')', place);
    if (end != text.npos)
        /* remove the file position from the error text, so that equal errors are counted together */
        text.erase(place, end + 1 - place);
    const size_t source = text.find(": "); /* skips the beginning of Assimp's log line (level and thread), such as "Error, T0" */
    counts[source == std::string::npos ? text : text.substr(source + 2)]++;
}

void assimp_losses_of_obj(const std::string &text)
{
    size_t surfaces = 0;
    for (size_t at = 0, next; at < text.size(); at = next) {
        surfaces += text.compare(at, 5, "surf ") == 0 || text.compare(at, 5, "surf\t") == 0;
        next = text.find('\n', at);
        next = next == std::string::npos ? text.size() : next + 1;
    }
    if (surfaces > 0)
        printf("error\t%zu\tPlantcast does not read free-form surfaces (surf), so they are not shown: export the surfaces as polygons\n",
               surfaces);
}

void assimp_losses_of_dae(const std::string &text)
{
    static const char end_tag[] = "</geometry>";
    for (size_t at = 0; (at = text.find("<geometry ", at)) != std::string::npos;) {
        const size_t close = text.find('>', at), end = text.find(end_tag, at);
        if (close == std::string::npos || end == std::string::npos)
            return;
        const std::string tag = text.substr(at, close - at);
        const bool shown = has_any(text, close, end, { "<triangles", "<polylist", "<polygons", "<tristrips", "<trifans" });
        const bool lines = has_any(text, close, end, { "<lines", "<linestrips" });
        const char *kind = has_any(text, close, end, { "<convex_mesh" }) ? "convex hulls" : "splines and boundary representations";
        if (!shown && !lines && has_any(text, close, end, { "<convex_mesh", "<spline", "<brep" }))
            printf("lost\t%s\t%s\tgeometry\t\tPlantcast does not read %s, so this geometry is not shown: export the geometry as polygons\n",
                   attribute(tag, "id").c_str(), attribute(tag, "name").c_str(), kind);
        at = end + strlen(end_tag);
    }
}

void assimp_plain_numbers(std::string *text)
{
    static const char *const kinds[] = { "INF", "IND", "NAN", "QNAN", "SNAN" };
    for (size_t at = 0; (at = text->find(".#", at)) != std::string::npos; at += 2) {
        size_t from = at, to = at + 2;
        while (from > 0 && (isdigit(static_cast<unsigned char>((*text)[from - 1])) || (*text)[from - 1] == '-'))
            from--;
        while (to < text->size() && isalpha(static_cast<unsigned char>((*text)[to])))
            to++;
        const std::string kind = text->substr(at + 2, to - at - 2);
        while (to < text->size() && isdigit(static_cast<unsigned char>((*text)[to])))
            to++;
        if (from < at && std::find(std::begin(kinds), std::end(kinds), kind) != std::end(kinds))
            text->replace(from, to - from, "nan" + std::string(to - from - 3, ' '));
    }
}
