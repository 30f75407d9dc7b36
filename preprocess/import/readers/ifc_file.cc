/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finds all statements of an IFC file in one pass; parses the values of a statement on demand. */
#include "preprocess/import/readers/ifc_file.hh"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace ifc
{

namespace
{

constexpr int MAX_NESTING = 64; /* maximum nesting depth of lists in an IFC file */

/* Returns the offset after the string, comment or single character of an IFC file that begins at `at`. */
size_t skip_one(const std::string &bytes, size_t at)
{
    size_t end = at + 1;
    if (bytes[at] == '\'')
        end = bytes.find('\'', at + 1);
    else if (bytes.compare(at, 2, "/*") == 0)
        end = bytes.find("*/", at + 2);
    else
        return end;
    return end == std::string::npos ? bytes.size() : end + (bytes[at] == '\'' ? 1 : 2);
}

struct ifc_parser {
    const std::string &bytes;
    size_t at;

    char next()
    {
        while (at < bytes.size() && (isspace(static_cast<unsigned char>(bytes[at])) || bytes.compare(at, 2, "/*") == 0))
            at = skip_one(bytes, at);
        return at < bytes.size() ? bytes[at] : '\0';
    }

    std::string word()
    {
        size_t from = at;
        while (at < bytes.size() && (isalnum(static_cast<unsigned char>(bytes[at])) || bytes[at] == '_'))
            at++;
        return bytes.substr(from, at - from);
    }

    value list(int depth)
    {
        value out;
        out.kind = value::LIST;
        if (depth > MAX_NESTING)
            throw unsupported("the IFC file is damaged: its lists are nested too deep");
        for (at++; next() != ')';) {
            out.list.push_back(one(depth + 1));
            if (next() == ',')
                at++;
            else if (next() != ')')
                throw unsupported("a statement of the IFC file is damaged: export the model again");
        }
        at++;
        return out;
    }

    value text()
    {
        value out;
        out.kind = value::TEXT;
        size_t from = ++at;
        for (; at < bytes.size(); at++)
            if (bytes[at] == '\'' && at + 1 < bytes.size() && bytes[at + 1] == '\'')
                at++;
            else if (bytes[at] == '\'')
                break;
        out.text = bytes.substr(from, at - from);
        at++;
        return out;
    }

    value number()
    {
        value out;
        char *end = nullptr;
        out.kind = value::NUMBER;
        out.number = strtod(bytes.c_str() + at, &end);
        if (end == bytes.c_str() + at || !std::isfinite(out.number))
            throw unsupported("a number in the IFC file is damaged: export the model again");
        at = static_cast<size_t>(end - bytes.c_str());
        return out;
    }

    value one(int depth)
    {
        value out;
        char c = next();
        if (c == '(')
            return list(depth);
        if (c == '\'')
            return text();
        if (c == '$' || c == '*') {
            at++;
            return out;
        }
        if (c == '#') {
            at++;
            out.kind = value::REFERENCE;
            out.id = atoi(word().c_str());
            return out;
        }
        if (c == '.') {
            size_t end = bytes.find('.', at + 1);
            if (end == std::string::npos)
                throw unsupported("a statement of the IFC file is damaged: export the model again");
            out.kind = value::NAME;
            out.text = bytes.substr(at, end + 1 - at);
            at = end + 1;
            return out;
        }
        if (isalpha(static_cast<unsigned char>(c))) { /* typed value, such as IFCLABEL('P-101') */
            std::string type = word();
            if (next() != '(')
                throw unsupported("a statement of the IFC file is damaged: export the model again");
            out = list(depth);
            out.text = type;
            return out;
        }
        return number();
    }
};

} // namespace

const value &entity::operator[](size_t at) const
{
    static const value none;
    return at < values.size() ? values[at] : none;
}

file::file(const char *path)
{
    std::ifstream in(path, std::ios::binary);
    if (!in)
        throw std::runtime_error("the IFC file cannot be opened");
    bytes.assign(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
    bool begins = true; /* true after a semicolon: the next '#' begins a statement */
    for (size_t at = 0; at < bytes.size();) {
        if (begins && bytes[at] == '#') {
            ifc_parser p = { bytes, at + 1 };
            int id = atoi(p.word().c_str());
            if (id > 0 && p.next() == '=') {
                p.at++;
                p.next();
                std::string type = p.word();
                if (!type.empty() && p.next() == '(')
                    places[id] = { type, p.at };
            }
            at = p.at > at ? p.at : at + 1;
            begins = false;
            continue;
        }
        if (bytes[at] == ';')
            begins = true;
        else if (bytes[at] != '/' && !isspace(static_cast<unsigned char>(bytes[at])))
            begins = false;
        at = skip_one(bytes, at);
    }
}

entity file::get(int id) const
{
    auto found = places.find(id);
    if (found == places.end())
        throw unsupported("#" + std::to_string(id) + " is missing");
    ifc_parser p = { bytes, found->second.at };
    entity out;
    out.id = id;
    out.type = found->second.type;
    out.values = p.list(0).list;
    return out;
}

entity file::get(const value &reference) const
{
    if (reference.kind != value::REFERENCE)
        throw unsupported("the IFC file is damaged: a statement lacks a reference to another statement");
    return get(reference.id);
}

double file::number(const value &from)
{
    if (from.kind == value::LIST && from.list.size() == 1)
        return number(from.list[0]);
    if (from.kind != value::NUMBER)
        throw unsupported("the IFC file is damaged: a statement lacks a number");
    return from.number;
}

double file::number(const value &from, double otherwise)
{
    return from.absent() ? otherwise : number(from);
}

void file::each(const std::function<void(int, const std::string &)> &f) const
{
    for (const auto &entry : places)
        f(entry.first, entry.second.type);
}

bool file::is_rooted(int id) const
{
    auto found = places.find(id);
    ifc_parser p = { bytes, found == places.end() ? bytes.size() : found->second.at + 1 };
    return p.next() == '\'';
}

} // namespace ifc
