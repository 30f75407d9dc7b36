/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is drawn in software, where there is no GPU. Thread: the one of the GL context. */
#ifndef RENDER_SOFT_BACKEND_H
#define RENDER_SOFT_BACKEND_H
#include "render/render_backend.h"
#include "render/soft/refined.h"
#include "render/soft/soft.h"

struct soft_backend {
    struct soft *soft;
    struct refiner *refiner;
};

#endif
