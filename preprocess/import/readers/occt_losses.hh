/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Prints the parts of a STEP or IGES file that Open CASCADE could not read, as report lines (format: findings.h) on stdout. Thread: one. */
#ifndef PREPROCESS_IMPORT_READERS_OCCT_LOSSES_HH
#define PREPROCESS_IMPORT_READERS_OCCT_LOSSES_HH
#include <XSControl_WorkSession.hxx>

#include <string>

/* Prints the errors that Open CASCADE found in the file and in its transfer, and a line for each body or surface that lacks faces.
 * file: the name of an external file followed by ": ", or "" for the main file. Call after the transfer. */
void occt_losses_say(const Handle(XSControl_WorkSession) & session, const std::string &file);

#endif
