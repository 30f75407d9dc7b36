/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One texture as large as the window. */
#include "screen.h"

#include <SDL2/SDL.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/mem.h"

struct screen {
    SDL_Window *window;
    SDL_Renderer *renderer;
    SDL_Texture *texture;
    int width_px, height_px;
    char name[80];
};

static bool fail(const char *what)
{
    fprintf(stderr, "plantcast-wall: %s: %s\n", what, SDL_GetError());
    return false;
}

static bool make_texture(struct screen *screen)
{
    if (screen->texture)
        SDL_DestroyTexture(screen->texture);
    SDL_GetRendererOutputSize(screen->renderer, &screen->width_px, &screen->height_px);
    screen->texture =
        SDL_CreateTexture(screen->renderer, SDL_PIXELFORMAT_RGB888, SDL_TEXTUREACCESS_STREAMING, screen->width_px, screen->height_px);
    return screen->texture != NULL;
}

/* Whether OpenGL is there, but without a GPU: plain pixels take a third of what it does then. */
static bool draws_by_processor(SDL_Renderer *renderer)
{
    static const char *const rasterizers[] = { "llvmpipe", "softpipe", "swrast", "Software Rasterizer" };
    enum { NAME_OF_RENDERER = 0x1F01 }; /* GL_RENDERER */
    SDL_RendererInfo info;
    if (SDL_GetRendererInfo(renderer, &info) != 0 || strncmp(info.name, "opengl", 6) != 0)
        return false;
    const unsigned char *(*get_string)(unsigned) = (const unsigned char *(*)(unsigned))SDL_GL_GetProcAddress("glGetString");
    const char *name = get_string ? (const char *)get_string(NAME_OF_RENDERER) : NULL;
    for (size_t i = 0; name && i < sizeof(rasterizers) / sizeof(rasterizers[0]); i++)
        if (strstr(name, rasterizers[i]))
            return true;
    return false;
}

/* The first that works: by a GPU, else by the processor alone. */
static bool make_renderer(struct screen *screen)
{
    static const Uint32 ways[] = { SDL_RENDERER_ACCELERATED, SDL_RENDERER_SOFTWARE };
    for (size_t i = 0; i < sizeof(ways) / sizeof(ways[0]); i++) {
        screen->renderer = SDL_CreateRenderer(screen->window, -1, ways[i]);
        bool wasted =
            screen->renderer && ways[i] == SDL_RENDERER_ACCELERATED && !getenv("SDL_RENDER_DRIVER") && draws_by_processor(screen->renderer);
        if (screen->renderer && !wasted && make_texture(screen))
            return true;
        if (screen->renderer)
            SDL_DestroyRenderer(screen->renderer);
        screen->renderer = NULL;
        screen->texture = NULL;
    }
    return fail("neither OpenGL nor plain pixels can be shown");
}

/* SDL 2.26 ends at a Wayland compositor without a seat, as one has to which no keyboard, mouse or touch screen is plugged: another process
   tries first. */
static bool survives_wayland(void)
{
    const char *driver = getenv("SDL_VIDEODRIVER");
    int status = 0;
    if (!getenv("WAYLAND_DISPLAY") || (driver && strcmp(driver, "wayland") != 0))
        return true;
    pid_t child = fork();
    if (child == 0) {
        signal(SIGSEGV, SIG_DFL);
        _exit(SDL_Init(SDL_INIT_VIDEO) != 0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child || !WIFSIGNALED(status))
        return true;
    fprintf(stderr,
            "plantcast-wall: SDL %d.%d.%d ends at this Wayland compositor, which has no seat: no keyboard, mouse or touch screen%s\n",
            SDL_MAJOR_VERSION, SDL_MINOR_VERSION, SDL_PATCHLEVEL, driver ? "" : "; another way is looked for");
    return false;
}

struct screen *screen_open(int width_px, int height_px, int monitor)
{
    struct screen *screen = mem_new(sizeof(*screen));
    int at = (int)SDL_WINDOWPOS_CENTERED_DISPLAY(monitor);
    SDL_RendererInfo info = { .name = "?" };
    SDL_SetHint(SDL_HINT_VIDEO_ALLOW_SCREENSAVER, "0");
    SDL_SetHint(SDL_HINT_VIDEO_MINIMIZE_ON_FOCUS_LOSS, "0");
    SDL_SetHint(SDL_HINT_RENDER_SCALE_QUALITY, "0");
    SDL_SetHint(SDL_HINT_NO_SIGNAL_HANDLERS, "1");
    SDL_SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0"); /* plain pixels go to the display as they are, not by OpenGL after all */
    if (!survives_wayland()) {
        if (getenv("SDL_VIDEODRIVER"))
            goto error;
        unsetenv("WAYLAND_DISPLAY");
    }
    if (SDL_Init(SDL_INIT_VIDEO) != 0) { /* no sound is asked for */
        fail("no display");
        goto error;
    }
    const char *driver = SDL_GetCurrentVideoDriver();
    if (!getenv("SDL_VIDEODRIVER") && (!strcmp(driver, "offscreen") || !strcmp(driver, "dummy"))) {
        fprintf(stderr, "plantcast-wall: no display: neither X11, Wayland nor KMS can be used\n"); /* nobody would see that one */
        goto error;
    }
    if (monitor >= SDL_GetNumVideoDisplays()) {
        fprintf(stderr, "plantcast-wall: --monitor %d: this machine has %d\n", monitor, SDL_GetNumVideoDisplays());
        goto error;
    }
    SDL_Rect all = { at, at, width_px, height_px };
    if (!width_px) /* as large from the start: an X server without a window manager makes nothing larger */
        SDL_GetDisplayBounds(monitor, &all);
    Uint32 flags = SDL_WINDOW_ALLOW_HIGHDPI | (width_px ? SDL_WINDOW_RESIZABLE : SDL_WINDOW_FULLSCREEN_DESKTOP | SDL_WINDOW_BORDERLESS);
    screen->window = SDL_CreateWindow("Plantcast", all.x, all.y, all.w, all.h, flags);
    if (!screen->window) {
        fail("no window");
        goto error;
    }
    if (!make_renderer(screen))
        goto error;
    SDL_ShowCursor(SDL_DISABLE);
    SDL_GetRendererInfo(screen->renderer, &info);
    snprintf(screen->name, sizeof(screen->name), "%s, %s, %dx%d", SDL_GetCurrentVideoDriver(), info.name, screen->width_px,
             screen->height_px);
    return screen;
error:
    screen_close(&screen);
    return NULL;
}

void screen_close(struct screen **screen_ptr)
{
    struct screen *screen = *screen_ptr;
    if (!screen)
        return;
    if (screen->texture)
        SDL_DestroyTexture(screen->texture);
    if (screen->renderer)
        SDL_DestroyRenderer(screen->renderer);
    if (screen->window)
        SDL_DestroyWindow(screen->window);
    SDL_Quit();
    mem_free(screen);
    *screen_ptr = NULL;
}

void screen_size(const struct screen *screen, int window_px[2], int display_px[2])
{
    SDL_DisplayMode mode;
    window_px[0] = display_px[0] = screen->width_px;
    window_px[1] = display_px[1] = screen->height_px;
    if (SDL_GetDesktopDisplayMode(SDL_GetWindowDisplayIndex(screen->window), &mode) == 0 && mode.w >= screen->width_px &&
        mode.h >= screen->height_px) {
        display_px[0] = mode.w;
        display_px[1] = mode.h;
    }
}

const char *screen_name(const struct screen *screen)
{
    return screen->name;
}

enum screen_event screen_poll(struct screen *screen)
{
    SDL_Event event;
    while (SDL_PollEvent(&event)) {
        if (event.type == SDL_QUIT)
            return SCREEN_QUIT;
        if (event.type == SDL_RENDER_TARGETS_RESET || event.type == SDL_RENDER_DEVICE_RESET)
            return make_texture(screen) ? SCREEN_EXPOSED : SCREEN_QUIT;
        if (event.type != SDL_WINDOWEVENT)
            continue;
        int width_px, height_px;
        SDL_GetRendererOutputSize(screen->renderer, &width_px, &height_px);
        if (width_px != screen->width_px || height_px != screen->height_px)
            return make_texture(screen) ? SCREEN_RESIZED : SCREEN_QUIT;
        if (event.window.event == SDL_WINDOWEVENT_EXPOSED)
            return SCREEN_EXPOSED;
    }
    return SCREEN_NOTHING;
}

void screen_update(struct screen *screen, cairo_surface_t *picture, const struct box *dirty)
{
    int stride = cairo_image_surface_get_stride(picture), width = cairo_image_surface_get_width(picture),
        height = cairo_image_surface_get_height(picture);
    int left = (int)fmax(0, floor(dirty->x)), top = (int)fmax(0, floor(dirty->y));
    int right = (int)fmin(fmin(width, screen->width_px), ceil(dirty->x + dirty->width));
    int bottom = (int)fmin(fmin(height, screen->height_px), ceil(dirty->y + dirty->height));
    SDL_Rect part = { left, top, right - left, bottom - top };
    if (part.w > 0 && part.h > 0)
        SDL_UpdateTexture(screen->texture, &part, cairo_image_surface_get_data(picture) + (size_t)top * (size_t)stride + (size_t)left * 4,
                          stride);
}

bool screen_present(struct screen *screen, int shift_x, int shift_y, double brightness, uint32_t ground)
{
    SDL_Rect to = { shift_x, shift_y, screen->width_px, screen->height_px };
    Uint8 light = (Uint8)lround(255 * brightness), rgb[3];
    for (int i = 0; i < 3; i++)
        rgb[i] = (Uint8)lround((ground >> (16 - 8 * i) & 255) * brightness);
    SDL_SetRenderDrawColor(screen->renderer, rgb[0], rgb[1], rgb[2], 255);
    SDL_RenderClear(screen->renderer);
    SDL_SetTextureColorMod(screen->texture, light, light, light);
    if (SDL_RenderCopy(screen->renderer, screen->texture, NULL, &to) != 0)
        return fail("the picture cannot be shown");
    SDL_RenderPresent(screen->renderer);
    return true;
}
