# SPDX-License-Identifier: GPL-3.0-or-later
# Builds Plantcast. `make run` builds and starts the demo plant, `make test` builds and runs the tests; README.md lists the other goals.
# config = release | debug | asan | tsan | fuzz;  CC = gcc | clang;  build = folder of all build results;
# CODECS = jpeg: builds without H.264, and therefore without libavcodec.
config ?= release
build  ?= build
.DEFAULT_GOAL := all
CODECS ?= jpeg h264
ifeq ($(origin CC),default)
CC := gcc
endif
CXX := $(if $(findstring clang,$(CC)),clang++,g++)

flags_release := -O3 -DNDEBUG -g1 -fstack-protector-strong -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3
flags_debug   := -O0 -g3
flags_asan    := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
flags_tsan    := -O1 -g -fsanitize=thread
flags_fuzz    := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined
# gcc defines these macros itself.
ifneq ($(findstring clang,$(CC)),)
flags_asan += -D__SANITIZE_ADDRESS__
flags_fuzz += -D__SANITIZE_ADDRESS__
flags_tsan += -D__SANITIZE_THREAD__
endif
ifeq ($(flags_$(config)),)
$(error config=$(config) is unknown: release, debug, asan, tsan or fuzz)
endif

out := $(build)/$(config)
gen := $(build)/gen
bin := $(if $(filter release,$(config)),$(build),$(out)/bin)

# Goals that compile nothing themselves, and therefore need no development packages.
no_packages := deps test-deps run test check test-long clean style layers deb bundle image test-deploy
packages := yaml-0.1 jansson sqlite3 libzstd libpq libcurl libmodbus libmosquitto libprotobuf-c libwebsockets libssl libcrypto cjose \
            libturbojpeg \
            uchardet libutf8proc \
            libjpeg libpng zlib cairo cairo-ft fontconfig libxxhash OpenImageIO
ifneq ($(filter-out jpeg h264,$(CODECS))$(if $(filter jpeg,$(CODECS)),,none),)
$(error CODECS=$(CODECS) is unknown: jpeg, or jpeg h264)
endif
ifneq ($(filter h264,$(CODECS)),)
packages += libavcodec libavformat libavutil
defines  := -DPLANTCAST_H264
endif
# The OPC UA library open62541. By default, deploy/open62541 builds it with patches against faults that a malicious server could exploit.
# OPEN62541=system links the system's library: use it only if that library contains these patches.
asked := $(or $(MAKECMDGOALS),all)
ifeq ($(OPEN62541)$(shell pkg-config --exists 'open62541 >= 1.4 open62541 < 1.5' 2>/dev/null && echo yes),systemyes)
opcua_cflags := $(shell pkg-config --cflags open62541)
opcua_libs   := $(shell pkg-config --libs open62541)
else ifneq ($(filter-out $(no_packages),$(asked)),)
-include $(build)/open62541/open62541.mk
$(build)/open62541/open62541.mk: deploy/open62541 deploy/open62541.patch
	@deploy/open62541 $(@D) $(CC)
endif
defines += $(if $(opcua_libs),-DPLANTCAST_OPCUA)
pkg_cflags := $(shell pkg-config --cflags $(packages) 2>/dev/null) $(opcua_cflags)
pkg_libs   := $(shell pkg-config --libs $(packages) 2>/dev/null) -lflann -lcholmod -llapack -lblas -lmeshoptimizer -ltinygltf -ldraco \
              -lyuv $(opcua_libs) -lm -ldl

# All other goals stop here with a list of the missing development packages.
ifneq ($(filter-out $(no_packages),$(asked)),)
missing := $(foreach p,$(packages),$(if $(shell pkg-config --exists $(p) 2>/dev/null && echo yes),,$(p))) \
           $(if $(wildcard /usr/bin/glad),,python3-glad)
ifneq ($(strip $(missing)),)
$(error packages are missing (make deps installs them): $(strip $(missing)))
endif
endif

warn   := -Wall -Wextra -Wshadow -Wpointer-arith -Wvla -Wundef -Wno-psabi
include := -I. -Iserver -I$(gen) -isystem $(gen)/glad/include -isystem /usr/include/suitesparse $(pkg_cflags)
common := $(flags_$(config)) $(defines) $(include) -MMD -MP -pthread -fno-math-errno -fPIE
cflags   = -std=c11 -D_GNU_SOURCE $(warn) -Wstrict-prototypes -Wmissing-prototypes \
           -Werror=int-conversion -Werror=incompatible-pointer-types $(common) $(CFLAGS)
cxxflags = -std=c++17 -D_GNU_SOURCE $(warn) $(common) $(CXXFLAGS)
ldflags  = $(flags_$(config)) -pthread -Wl,--as-needed -Wl,-z,relro,-z,now $(LDFLAGS)

# --- programs and archives: one archive per layer, in link order ------------------------------------------------------------------
layers   := base audit plant surface value history alarm notify loopcheck views corelink scene field placing importing gpu render encode \
            provenance message service access session net
layers   := $(foreach l,$(layers),$(if $(wildcard server/$(l)/*.c),$(l)))
lazy     := $(if $(filter h264,$(CODECS)),server/encode/h264_lazy.c)
without  := $(if $(filter h264,$(CODECS)),,$(wildcard server/encode/h264*)) $(lazy) server/base/image/image_shim.cc \
            $(if $(opcua_libs),,$(wildcard server/value/opcua/*))
archives := $(foreach l,$(layers),$(out)/lib/$(l).a) $(out)/lib/protocol.a
objects   = $(patsubst %,$(out)/obj/%.o,$(basename $(1)))
link      = @mkdir -p $(@D); echo "  LINK $@"; \
            $(CXX) $(ldflags) -pie -o $@ $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group $(pkg_libs)

sim_sources      := $(wildcard deploy/demo/*.c)
sim_archive      := $(if $(sim_sources),$(out)/lib/sim.a)
import_sources   := $(wildcard preprocess/import/*.c preprocess/import/revision/*.c)
match_sources    := $(wildcard preprocess/match/*.c)
prep_sources     := $(filter-out %/main.c $(import_sources) $(match_sources), \
                    $(wildcard preprocess/*.c preprocess/*/*.c preprocess/*/*.cc))
programs := $(if $(wildcard server/main.c),$(bin)/plantcastd) $(if $(wildcard preprocess/main.c),$(bin)/plantcast-prep) \
            $(if $(wildcard clients/cli/main.c),$(bin)/plantcast) $(if $(filter h264,$(CODECS)),$(bin)/plantcast-film) \
            $(if $(import_sources),$(bin)/plantcast-import) \
            $(if $(filter %/main.c,$(match_sources)),$(bin)/plantcast-match) $(if $(sim_sources),$(bin)/plantcast-sim)
# Scripts that set up, back up and restore the service.
scripts  := $(addprefix $(bin)/plantcast-,init backup restore)
modules  := $(bin)/plantcast-images.so $(if $(filter h264,$(CODECS)),$(bin)/plantcast-h264.so)
# Importers of other CAD formats. Each is built if its library is installed (`plantcast import --formats` lists them).
occt     := $(dir $(wildcard /usr/include/opencascade/STEPCAFControl_Reader.hxx))
# OpenCASCADE 7.8 (Debian 13) renamed the libraries of its STEP and IGES readers.
occt_libs := $(if $(wildcard /usr/lib/*/libTKDESTEP.so),DESTEP DEIGES,XDESTEP XDEIGES STEP STEPBase IGES)
occt_libs := $(patsubst %,-lTK%,$(occt_libs) XSBase RWMesh XCAF LCAF CAF CDF Mesh Offset Fillet Bool BO ShHealing Prim TopAlgo GeomAlgo \
    GeomBase BRep G3d G2d Math ernel)
assimp   := $(wildcard /usr/include/assimp/Importer.hpp)
readers  := $(if $(occt),$(bin)/plantcast-import-occt) $(if $(assimp),$(bin)/plantcast-import-assimp)
# plantcast-video (clients/video) is built if its libraries are installed; otherwise the build lists the missing ones.
video_packages := gio-2.0 gstreamer-app-1.0 gstreamer-rtsp-server-1.0 pangocairo jansson
video_missing := $(if $(filter h264,$(CODECS)),,H.264) \
    $(foreach p,$(video_packages),$(if $(shell pkg-config --exists $(p) 2>/dev/null && echo yes),,$(p)))
video := $(if $(strip $(video_missing)),,$(bin)/plantcast-video)
video_cflags := $(if $(video),$(patsubst -I%,-isystem %,$(shell pkg-config --cflags $(video_packages))))

.PHONY: all programs web run demo test check test-long bench gpu-bench style layers headers deps test-deps golden-update install clean help
all: $(programs) $(or $(video),no-video) $(scripts) $(modules) $(readers) \
    $(bin)/plantcast-import-ifc/ifc.mjs web
# The page's chart library. The build fails without it.
clients/web/vendor/uPlot.js: clients/web/package-lock.json
	@echo "  NPM  $(@D)"; deploy/vendor $(build)/npm && touch $@
# The IFC importer, with its library from npm. Without a network the build continues, and `plantcast import` refuses IFC files.
ifc := preprocess/import/readers/package-lock.json $(wildcard preprocess/import/readers/*.mjs)
$(bin)/plantcast-import-ifc/ifc.mjs: $(ifc)
	@echo "  IFC  $(@D)"; deploy/vendor_ifc $(build)/npm-ifc $(@D); [ ! -f $@ ] || touch $@
# Generated modules of the page: its icons, the constants that it shares with the shaders, and its version.
page := $(filter-out clients/web/made/%,$(wildcard $(addprefix clients/web/,*.* */*.* */*/*.* */*/*/*.*)))
clients/web/made/version.js: deploy/stamp deploy/join $(page) clients/web/vendor/uPlot.js shaders/constants.glsl
	@echo "  WEB  $(@D)"; deploy/stamp clients/web shaders/constants.glsl deploy/join
# The page as the daemon serves it, with the modules of its first load joined.
web: $(bin)/web/app/first.js
$(bin)/web/app/first.js: deploy/join clients/web/made/version.js
	@echo "  WEB  $(bin)/web"; deploy/join clients/web $(bin)/web
programs: all
no-video:
	@echo "  without plantcast-video, a view as video: no $(strip $(video_missing))"
.PHONY: no-video
$(scripts): $(bin)/plantcast-%: deploy/%
	@mkdir -p $(@D); cp $< $@

# Shared objects that programs load on demand: readers of images, and the H.264 encoder.
$(programs): $(call objects,$(lazy)) | $(modules)
$(bin)/plantcastd: $(call objects,$(wildcard server/*.c)) $(archives)
	$(link)
$(bin)/plantcast-prep: $(call objects,preprocess/main.c) $(out)/lib/prep.a $(archives)
	$(link)
# The importer reads untrusted files, so its code is linked neither into the daemon nor into plantcast-prep.
$(bin)/plantcast-import: $(call objects,preprocess/import/main.c) $(out)/lib/import.a $(out)/lib/match.a $(out)/lib/prep.a $(archives)
	$(link) -lGLU -lminizip -lz
by_occt := $(call objects,$(basename $(filter-out preprocess/import/readers/assimp%,$(wildcard preprocess/import/readers/*.cc))))
by_reader := $(call objects,preprocess/import/encoding)
$(by_occt): CXXFLAGS += -isystem $(occt)
$(bin)/plantcast-import-occt: $(by_occt) $(by_reader) $(out)/lib/prep.a $(out)/lib/base.a
	@mkdir -p $(@D); echo "  LINK $@"
	@$(CXX) $(ldflags) -pie -o $@ $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group \
	    $(occt_libs) -luchardet -ljansson
by_assimp := $(call objects,$(wildcard preprocess/import/readers/assimp*.cc))
$(bin)/plantcast-import-assimp: $(by_assimp) $(by_reader) $(out)/lib/prep.a $(out)/lib/base.a
	@mkdir -p $(@D); echo "  LINK $@"
	@$(CXX) $(ldflags) -pie -o $@ $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group -lassimp -luchardet -ljansson -lm
$(bin)/plantcast-match: $(call objects,preprocess/match/main.c) $(out)/lib/match.a $(out)/lib/prep.a $(archives)
	$(link) -lminizip -lexpat
$(bin)/plantcast-images.so: $(patsubst %,$(out)/obj/server/base/%.pic.o,image/image_shim mem)
	@mkdir -p $(@D); echo "  LINK $@"; $(CXX) $(ldflags) -shared -o $@ $^ $(pkg_libs)
$(bin)/plantcast-h264.so: $(patsubst %,$(out)/obj/%.pic.o,$(addprefix server/encode/h264_,codec upload) clients/link/h264_decoder \
    server/base/mem)
	@mkdir -p $(@D); echo "  LINK $@"; $(CXX) $(ldflags) -shared -o $@ $^ $(pkg_libs)
link_lazy := $(if $(filter h264,$(CODECS)),clients/link/h264_decoder_lazy.c)
$(out)/lib/link.a: $(call objects,$(filter-out $(if $(link_lazy),%_lazy.c,clients/link/h264%),$(wildcard clients/link/*.c)))
$(out)/lib/cli.a: $(call objects,$(filter-out %/main.c,$(wildcard clients/cli/*.c clients/cli/*/*.c)))
$(bin)/plantcast: $(call objects,clients/cli/main.c $(link_lazy)) $(out)/lib/cli.a $(out)/lib/link.a $(archives)
	$(link)
# Only plantcast-film links libavformat.
$(bin)/plantcast-film: $(call objects,$(wildcard clients/film/*.c)) $(out)/lib/cli.a $(out)/lib/link.a $(archives)
	$(link)
# Only plantcast-video links GStreamer and Pango.
video_objects := $(call objects,$(if $(video),$(wildcard clients/video/*.c)))
$(video_objects) $(patsubst %,$(out)/obj/%.alone,$(wildcard clients/video/*.h)): CFLAGS += $(video_cflags)
$(bin)/plantcast-video: $(video_objects) $(call objects,$(lazy)) $(out)/lib/link.a $(archives)
	$(link) $(shell pkg-config --libs $(video_packages))
$(bin)/plantcast-sim: $(call objects,$(sim_sources)) $(archives)
	$(link)

embedded := $(out)/obj/gen/embedded.o
glad     := $(out)/obj/gen/glad/src/gl.o $(out)/obj/gen/glad/src/egl.o
define archive_rule
$(out)/lib/$(1).a: $(call objects,$(filter-out $(without),$(wildcard $(foreach d,* */*,server/$(1)/$(d).c server/$(1)/$(d).cc)))) \
    $(if $(filter base,$(1)),$(embedded)) $(if $(filter gpu,$(1)),$(glad))
endef
$(foreach l,$(layers),$(eval $(call archive_rule,$(l))))
# Loops of the software rasterizer, compiled again for AVX2 (`wide`) and for AVX-512 (`widest`); see render/soft/kernels.h.
wide_names := depth_cells faces feature_edges kernels pixel_lists raster resolve resolve_field resolve_preview resolve_surfaces
wide_sources := $(wide_names:%=server/render/soft/%.c)
wide_objects := $(foreach w,wide widest,$(patsubst %.c,$(out)/obj/%.$(w).o,$(wide_sources)))
$(out)/lib/render.a: $(if $(filter x86_64%,$(shell $(CC) -dumpmachine 2>/dev/null)),$(wide_objects))
$(out)/lib/protocol.a: $(call objects,$(wildcard protocol/*.c))
$(out)/lib/prep.a: $(call objects,$(prep_sources))
$(out)/lib/import.a: $(call objects,$(filter-out %/main.c,$(import_sources)))
$(out)/lib/match.a: $(call objects,$(filter-out %/main.c,$(match_sources)))
$(out)/lib/sim.a: $(call objects,$(filter-out %/sim.c,$(sim_sources)))
$(out)/lib/%.a:
	@mkdir -p $(@D); rm -f $@; $(AR) rcs $@ $^

# Generated headers.
made_headers := $(gen)/glad/include/glad/gl.h $(gen)/colormaps.h $(gen)/engineers.h $(patsubst %,$(gen)/words_%.h,refused overlay video)
# The compiler vectorises loops that select one of two numbers only if comparisons cannot trap.
$(call objects,$(addsuffix .c,server/surface/surface_field preprocess/subdivision/interp_weights protocol/distance_pack)): \
    CFLAGS += -fno-trapping-math
$(out)/obj/%.o: %.c Makefile $(out)/codecs | $(made_headers)
	@mkdir -p $(@D); echo "  CC   $<"
	@$(CC) $(cflags) -c -o $@ $<
$(out)/obj/%.o: %.cc Makefile | $(made_headers)
	@mkdir -p $(@D); echo "  CXX  $<"
	@$(CXX) $(cxxflags) -c -o $@ $<
$(out)/obj/%.wide.o: %.c Makefile | $(made_headers)
	@mkdir -p $(@D); echo "  CC   $< (wide)"
	@$(CC) $(cflags) -mavx2 -DSOFT_SET=_wide -c -o $@ $<
# No fused multiply-add: its rounding would give other pixels than the other instruction sets.
$(out)/obj/%.widest.o: %.c Makefile | $(made_headers)
	@mkdir -p $(@D); echo "  CC   $< (widest)"
	@$(CC) $(cflags) -mavx2 $(addprefix -mavx512,f vl bw dq) -mprefer-vector-width=256 -ffp-contract=off -DSOFT_SET=_widest -c -o $@ $<
$(out)/obj/%.pic.o: %.c Makefile | $(made_headers)
	@mkdir -p $(@D); echo "  CC   $< (shared)"
	@$(CC) $(cflags) -fPIC -c -o $@ $<
$(out)/obj/%.pic.o: %.cc Makefile
	@mkdir -p $(@D); echo "  CXX  $< (shared)"
	@$(CXX) $(cxxflags) -fPIC -c -o $@ $<
$(out)/obj/gen/%.o: $(gen)/%.c
	@mkdir -p $(@D)
	@$(CC) $(cflags) -w -c -o $@ $<

# The parser of Sparkplug B messages (server/value/mqtt/).
$(gen)/sparkplug_b.pb-c.c: server/value/mqtt/sparkplug_b.proto
	@mkdir -p $(@D); echo "  PB   $<"; protoc-c --proto_path=$(<D) --c_out=$(@D) $<
$(gen)/sparkplug_b.pb-c.h: $(gen)/sparkplug_b.pb-c.c ;
$(out)/obj/server/value/mqtt/sparkplug_payload.o: | $(gen)/sparkplug_b.pb-c.h
$(out)/lib/value.a: $(out)/obj/gen/sparkplug_b.pb-c.o

# The loaders of GL and EGL. glad generates them without a network.
$(gen)/glad/src/gl.c $(gen)/glad/src/egl.c: $(gen)/glad/include/glad/gl.h
$(gen)/glad/include/glad/gl.h:
	@mkdir -p $(gen); echo "  GLAD $(gen)/glad"
	@/usr/bin/python3 /usr/bin/glad --quiet --reproducible --api gl:core=4.5,egl=1.5 --out-path $(gen)/glad.new \
	    c --loader >$(gen)/glad.log 2>&1 || { cat $(gen)/glad.log; exit 1; }
	@rm -rf $(gen)/glad; mv $(gen)/glad.new $(gen)/glad

# The commit that the metric plantcast_build_info reports. Set COMMIT=... to build outside a repository.
COMMIT ?= $(or $(shell git rev-parse --short=12 HEAD 2>/dev/null),unknown)
$(shell mkdir -p $(gen); echo '#define PLANTCAST_COMMIT "$(COMMIT)"' | cmp -s - $(gen)/commit.h || \
        echo '#define PLANTCAST_COMMIT "$(COMMIT)"' >$(gen)/commit.h)

# Shaders and the fleet page as C strings that are looked up by name (server/base/text/embedded.h).
embedded_files := $(wildcard shaders/*.vert shaders/*.frag shaders/*.comp shaders/*.glsl clients/fleet/* \
                             clients/web/core/phrases.js clients/web/words/fleet.*.js)
$(gen)/embedded.c: deploy/embed $(embedded_files)
	@mkdir -p $(@D); deploy/embed $(embedded_files) >$@.new && mv $@.new $@

# The built-in colour maps, the default one first.
color_maps := $(patsubst %,shaders/maps/%.csv,relief calm viridis cividis diverging turbo operator)
$(gen)/colormaps.h: deploy/colormaps $(color_maps)
	@mkdir -p $(@D); deploy/colormaps $(color_maps) >$@.new && mv $@.new $@

# Parameters for engineers only, from the page's list: X(name, part of the name of its bit in enum params_given).
$(gen)/engineers.h: clients/web/core/session.js
	@mkdir -p $(@D); sed -n "s/^export const ENGINEERS = \[\(.*\)\];.*/\1/p" $< | tr -d "' " | tr , '\n' | \
	    awk 'BEGIN { printf "#define ENGINEERS_PARAMS(X)" } { bit = toupper($$0); sub(/_M$$/, "", bit); printf " X(%s, %s)", $$0, bit } \
	         END { print ""; exit NR == 0 }' >$@.new && mv $@.new $@

# Texts that programs share with the page: one file per subject and language.
word_files = $(foreach l,$(2),clients/web/words/$(1).$(l).js)
$(gen)/words_refused.h: $(call word_files,refused,en)
$(gen)/words_overlay.h: $(call word_files,overlay,en ko de)
$(gen)/words_video.h: $(call word_files,video,en ko de)
$(gen)/words_%.h: deploy/words
	@mkdir -p $(@D); deploy/words $* $(filter %.js,$^) >$@.new && mv $@.new $@

# --- tests: one program per file --------------------------------------------------------------------------------------------
unit_tests := $(patsubst tests/%.c,$(out)/tests/%,$(wildcard tests/unit/*_test.c))
gpu_tests  := $(patsubst tests/%.c,$(out)/tests/%,$(wildcard tests/gpu/*_test.c))
# Test support is an archive, so that each test links only the members that it uses, not the 285 libraries of all members together.
support    := $(out)/lib/support.a
$(support): $(call objects,$(wildcard tests/support/*.c tests/support/*.cc))
# Tests that compare distances with an exact solver of CGAL.
$(foreach t,accuracy along_truth contact,$(out)/tests/unit/$(t)_test): $(call objects,$(wildcard tests/oracle/*.cc))
$(foreach t,accuracy along_truth contact,$(out)/tests/unit/$(t)_test): pkg_libs += -lgmp -lmpfr
$(foreach t,rvm rvm_fuzz outline_fuzz,$(out)/tests/unit/$(t)_test): $(out)/lib/import.a
$(out)/tests/unit/revision_test: $(out)/lib/import.a $(out)/lib/match.a
$(out)/tests/unit/rvm_test $(out)/tests/unit/rvm_fuzz_test $(out)/tests/unit/revision_test: pkg_libs += -lGLU
$(out)/tests/unit/revision_test: pkg_libs += -lminizip -lexpat
match_tests := $(foreach t,match tag_export tag_rows tag_list_fuzz,$(out)/tests/unit/$(t)_test)
$(match_tests): $(out)/lib/match.a
$(match_tests): pkg_libs += -lminizip -lexpat
# Writes STEP and IGES files for the tests of the importer.
$(out)/obj/tests/cad/step_samples.o: CXXFLAGS += -isystem $(occt)
$(out)/tests/cad/step_samples: $(call objects,tests/cad/step_samples)
	@mkdir -p $(@D); echo "  LINK $@"; $(CXX) $(ldflags) -pie -o $@ $^ $(occt_libs)
$(out)/tests/bench/codec_bench: $(out)/lib/link.a
# Copies of the loadable modules, in the place relative to the tests where programs search for theirs.
modules_of_tests := $(addprefix $(out)/tests/lib/plantcast/,$(notdir $(modules)))
$(modules_of_tests): $(out)/tests/lib/plantcast/%: $(bin)/%
	@mkdir -p $(@D); cp $< $@.new && mv $@.new $@
$(out)/tests/%: $(out)/obj/tests/%.o $(call objects,$(lazy)) $(support) $(archives) $(out)/lib/prep.a $(sim_archive) | $(modules_of_tests)
	$(link) -lcmocka
# Programs that use the drawing code of the command line.
$(out)/tests/gallery/album $(out)/tests/validation/compare: $(out)/lib/cli.a $(out)/lib/link.a
$(out)/tests/validation/compare: ldflags += -Wl,--wrap=field_scalars_of
# A libEGL that tests preload to simulate a failing GPU.
$(out)/tests/faults/libEGL.so.1: $(out)/obj/tests/faults/gl_faults.pic.o
	@mkdir -p $(@D); echo "  LINK $@"; $(CC) $(ldflags) -shared -o $@ $<
# Libraries that tests preload to kill a program at a chosen call, or to change its clock. Built without sanitizers, because they are
# also preloaded into programs without a sanitizer, and run where LeakSanitizer cannot work.
$(out)/obj/tests/faults/%.o: CFLAGS += -fno-sanitize=all
$(out)/tests/faults/%: ldflags += -fno-sanitize=all
$(out)/tests/faults/%.so: $(out)/obj/tests/faults/%.pic.o
	@mkdir -p $(@D); echo "  LINK $@"; $(CC) $(ldflags) -shared -o $@ $<
# Replaces an importer's reader in tests of its sandbox.
$(out)/tests/faults/escape: $(out)/obj/tests/faults/escape.o
	@mkdir -p $(@D); echo "  LINK $@"; $(CC) $(ldflags) -pie -o $@ $<
# These tests make chosen allocations fail.
$(out)/tests/unit/relocation_test $(out)/tests/gpu/drawn_error_test: private ldflags += -Wl,--wrap=mem_try_array
$(out)/tests/gpu/field_memory_test: ldflags += -Wl,--wrap=mem_try_array,--wrap=pool_take
# This test resolves a host name to addresses of its choice.
$(out)/tests/unit/modbus_test: private ldflags += -Wl,--wrap=getaddrinfo
# This test sets the wall clock.
$(out)/tests/unit/historian_test: ldflags += -Wl,--wrap=clock_utc_ns
.SECONDARY:

include tests/tests.mk
include deploy/deploy.mk

clean:
	rm -rf $(build)

# Objects depend on this stamp, so that a build with other codecs or without OPC UA recompiles them. Goals in no_packages do not check
# for OPC UA, and do not write the stamp.
ifneq ($(filter-out $(no_packages),$(asked)),)
parts := $(CODECS) $(if $(opcua_libs),opcua)
$(shell mkdir -p $(out); echo '$(parts)' | cmp -s - $(out)/codecs || echo '$(parts)' >$(out)/codecs)
endif

-include $(shell find $(out)/obj -name '*.d' 2>/dev/null)
