/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The tree of an IGES file as an XCAF assembly, as STEP files come. */
#ifndef PREPROCESS_IMPORT_READERS_IGES_TREE_HH
#define PREPROCESS_IMPORT_READERS_IGES_TREE_HH
#include <IGESControl_Reader.hxx>
#include <TDocStd_Document.hxx>

#include <string>

#include "preprocess/import/readers/reader.hh"

/* Transfers the file that `iges` has read: groups and subfigures become assemblies, an instance of a subfigure a place of its part, solids and
 * the loose surfaces of a group parts; with names, colours and layers. Shapes are mended
 * part by part; what is mended while it is transferred (read.iges.sequence) would not be found by its entity. Names and layers are converted from
 * `encoding`. Throws what Open CASCADE throws. */
void iges_tree_add(IGESControl_Reader &iges, const Handle(TDocStd_Document) & document, const struct text_encoding &encoding);
/* What the file says that its unit is; "": nothing. */
std::string iges_units(IGESControl_Reader &iges);

#endif
