/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Builds the solids of an IFC file that web-ifc cannot build correctly. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_IFC_SHAPES_HH
#define PREPROCESS_IMPORT_READERS_IFC_SHAPES_HH

/* Builds pipes, surfaces of revolution and solids with curved faces, and writes them as a GLB file for ifc.mjs, in metres with Y up. Each
 * element is a node named by its statement number, such as "#44"; its children are its items, also named by their numbers. The element's
 * property "whole" says that these items are all of its geometry. The node "failed" has a property for each item that could not be built,
 * with the reason. The node "placements" has a property for each placement in a grid, with the statements of an equal local placement.
 * asked: path of a list of elements of which all items are built, whatever their type; the file may be missing. Writes no
 * file if there is nothing to build. Throws std::runtime_error if the input cannot be read. */
void ifc_shapes_write(const char *input, const char *output, double chord_mm, const char *asked);

#endif
