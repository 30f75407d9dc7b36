/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The statements of an IFC file (ISO 10303-21), parsed when they are asked for. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_IFC_FILE_HH
#define PREPROCESS_IMPORT_READERS_IFC_FILE_HH
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace ifc
{

/* Thrown where a statement is damaged, missing, or of a kind that this reader does not build. */
struct unsupported : std::runtime_error {
    using std::runtime_error::runtime_error;
};

struct value {
    enum kind_of { ABSENT, NUMBER, TEXT, NAME, REFERENCE, LIST } kind = ABSENT;
    double number = 0;
    int id = 0;              /* of REFERENCE */
    std::string text;        /* of TEXT, still escaped; of NAME, such as ".T."; of LIST, its type if it is typed, such as "IFCLABEL" */
    std::vector<value> list; /* of LIST */

    bool absent() const { return kind == ABSENT; }
    bool is(const char *name) const { return kind == NAME && text == name; }
    bool is_true() const { return is(".T."); }
};

struct entity {
    int id = 0;
    std::string type; /* "IFCWALL" */
    std::vector<value> values;

    /* Returns the value at a place; ABSENT where the statement is shorter. */
    const value &operator[](size_t at) const;
    bool is(const char *name) const { return type == name; }
};

class file
{
  public:
    /* Reads the file at `path` and finds its statements. Throws std::runtime_error if it cannot be read. */
    explicit file(const char *path);
    /* Returns a statement. Throws unsupported if it is missing or damaged. */
    entity get(int id) const;
    /* Returns the statement that a value refers to. Throws as above, also where the value is no reference. */
    entity get(const value &reference) const;
    /* Returns the number that a value is, also within a measure such as IFCPARAMETERVALUE(1.). Throws unsupported if it is none. */
    static double number(const value &from);
    static double number(const value &from, double otherwise);
    /* Calls f(id, type) for each statement, in the order of their ids. */
    void each(const std::function<void(int, const std::string &)> &f) const;
    /* Whether a statement's values begin with a text, as those of all products do. */
    bool is_rooted(int id) const;

  private:
    struct statement_place {
        std::string type;
        size_t at; /* of its opening bracket */
    };
    std::string bytes;
    std::map<int, statement_place> places;
};

} // namespace ifc

#endif
