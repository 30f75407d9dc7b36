/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Throws an exception that says why a model is rejected. */
#include <cstdarg>
#include <cstdio>

#include "preprocess/model/gltf_impl.hh"

namespace gltf
{

void refuse(const char *fmt, ...)
{
    char text[MODEL_WHY_BYTES];
    va_list ap;
    va_start(ap, fmt);
    vsnprintf(text, sizeof(text), fmt, ap);
    va_end(ap);
    throw gltf_refusal(text);
}

} // namespace gltf
