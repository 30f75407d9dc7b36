/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The version of all programs. */
#ifndef SERVER_VERSION_H
#define SERVER_VERSION_H

#define PLANTCAST_VERSION "0.1.0"

#endif
