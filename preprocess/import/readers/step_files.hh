/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prepares copies of STEP files for Open CASCADE: names in UTF-8, and references to external files rewritten to the names of their copies.
 * Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_STEP_FILES_HH
#define PREPROCESS_IMPORT_READERS_STEP_FILES_HH
#include <map>
#include <string>
#include <vector>

struct step_external {
    std::string named; /* as the file that refers to it writes it */
    bool found;
};

struct step_files {
    std::string main;                               /* path to read: the file itself or its copy */
    std::map<std::string, step_external> externals; /* by the name that copies use for it, such as "external_1.stp" */
    std::vector<std::string> copies;                /* paths to remove after reading */
};

/* Prepares a STEP file and all STEP files that it refers to and that lie in its folder. Writes copies into `folder`. Prints the encoding
 * of the names. asked: the encoding that the user wants, or "-". Refuses what cannot be read. */
step_files step_files_prepare(const std::string &path, const std::string &folder, const char *asked);

/* Open CASCADE takes a name whose last character is not ASCII for an empty name. Copies end such names with a mark: removes it. */
std::string step_name_without_mark(std::string name);

#endif
