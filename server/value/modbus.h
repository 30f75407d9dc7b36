/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The source kind "modbus": Modbus TCP, read only. */
#ifndef VALUE_MODBUS_H
#define VALUE_MODBUS_H
#include "value/source.h"

extern const struct source_impl modbus_impl;

#endif
