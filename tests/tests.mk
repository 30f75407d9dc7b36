# SPDX-License-Identifier: GPL-3.0-or-later
# Goals that run tests, checks of the source, and benchmarks.
jobs := -j$(shell nproc)
test: test-deps
	@deploy/compile $(build)/compile.log $(MAKE) --no-print-directory $(jobs) tests checked
	@tests/run $(out) $(bin) quick
# The tests to run before each commit.
check: test-deps
	@deploy/compile $(build)/compile.log $(MAKE) --no-print-directory $(jobs) tests checked
	@tests/run $(out) $(bin) check
# All sweeps in full and each GL test on each context; then a build with clang, and the tests under each sanitizer.
test-long: test-deps
	@deploy/compile $(build)/compile.log $(MAKE) --no-print-directory $(jobs) tests checked
	@tests/run $(out) $(bin) whole
	@deploy/deps build test long
	@$(MAKE) --no-print-directory CC=clang build=$(build)/clang all tests
	@for c in asan tsan; do \
	    $(MAKE) --no-print-directory config=$$c all tests && tests/run $(build)/$$c $(build)/$$c/bin unit && \
	    tests/run $(build)/$$c $(build)/$$c/bin gpu && tests/run $(build)/$$c $(build)/$$c/bin daemon || exit 1; \
	done
	@KILLS=100 $(out)/tests/unit/historian_test
	@PLANTCAST_FUZZ_ROUNDS=200000 $(out)/tests/unit/rvm_fuzz_test
	@REPLAY_S=3600 $(out)/tests/unit/modbus_history_test
	@PLANTCAST_BIN=$(bin) node --test tests/long/replay.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_LONG=1 USE_S=1800 node --test --test-name-pattern='memory' tests/e2e/list_pages/assets.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_LONG=1 USES=1440 MEMORY_MB=2048 node --test tests/e2e/memory.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) LOSSES=20 node --test tests/e2e/wall_pages/losses.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) PLANTCAST_LONG=1 LOSSES=20 node --test tests/e2e/gpu.mjs
	@PLANTCAST_BIN=$(bin) VIDEO_S=600 node --test --test-name-pattern='every second' tests/e2e/video.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) HELD_S=600 node --test --test-name-pattern='two, ten and all' tests/e2e/wall_pictures.mjs
	@$(MAKE) --no-print-directory validation scale soak
# Prepares 10 million triangles in 2,000 assets within 8 GB, is killed, and continues. Takes some minutes.
scale: all $(out)/tests/scale/facility
	@tests/scale/run $(out) $(bin) --kill
	@tests/scale/run $(out) $(bin) --singles 250 --assets 100 --triangles 22200

# Simulates a day of a plant in one hour (`make soak minutes=5`: in five minutes), then half an hour of clients that connect, drag, stall
# and disconnect, then two hours of a whole host with a fault each minute. `make soak-host minutes=30` runs only the last part.
soak: all tests
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) MINUTES=$(or $(minutes),60) node --test tests/long/day.mjs
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) SOAK_S=$(or $(SOAK_S),1800) node --test tests/e2e/flow.mjs
	@$(MAKE) --no-print-directory soak-host
# seed=N repeats the order of the faults of an earlier run. The run updates the table in build/soak-host.txt after each fault.
soak-host: all $(out)/tests/faults/clock_off.so
	@PLANTCAST_BIN=$(bin) PLANTCAST_OUT=$(out) MINUTES=$(or $(minutes),120) $(if $(seed),SEED=$(seed)) \
	    tests/long/contained node tests/long/host.mjs
.PHONY: soak soak-host

checked: demo plants style layers headers
# Prepares the plants that many tests use, if their models are present.
plants: $(foreach p,$(if $(wildcard ../shared/data/models/plm_plant_equipment.glb),plant_room) \
    $(if $(wildcard ../shared/data/models/cookie_factory_mixer.glb),cookie_line),$(out)/prepared/$(p))
$(out)/prepared/%: tests/plants/%.yaml FORCE | $(bin)/plantcast-prep
	@mkdir -p $@; $(bin)/plantcast-prep $< --output $@ >$@.log 2>&1 || { cat $@.log; exit 1; }
.PHONY: plants FORCE
tests: all $(unit_tests) $(gpu_tests) $(out)/tests/scale/facility $(out)/tests/relay/relay $(out)/tests/faults/libEGL.so.1 \
    $(out)/tests/faults/kill_at_rename.so $(out)/tests/faults/clock_off.so $(out)/tests/faults/late_peer.so \
    $(out)/tests/faults/escape $(out)/tests/faults/escape.so $(out)/tests/validation/compare \
    $(if $(occt),$(out)/tests/cad/step_samples)
unit: tests
	@tests/run $(out) $(bin) unit
gpu: tests
	@tests/run $(out) $(bin) gpu

style:
	@tests/style
layers:
	@tests/layers
# Checks that each header compiles alone. Headers are checked again when they or their includes change. An empty file includes the header,
# because clang warns of unused functions and constants in the file itself.
stand_alone := $(filter-out $(if $(video),,clients/video/%),$(shell git ls-files -co --exclude-standard '*.h'))
stand_alone := $(patsubst %.h,$(out)/obj/%.h.alone,$(stand_alone))
headers: $(stand_alone)
$(out)/obj/%.h.alone: %.h | $(made_headers)
	@mkdir -p $(@D) && $(CC) $(filter-out -MMD,$(cflags)) -MD -MF $(@:.alone=.d) -MT $@ -fsyntax-only \
	    -x c -include $< - </dev/null && touch $@

bench_programs := $(patsubst tests/%.c,$(out)/tests/%,$(wildcard tests/bench/*_bench.c))
bench: test-deps
	@$(MAKE) --no-print-directory all demo $(bench_programs) $(out)/tests/scale/facility $(out)/tests/relay/relay
	@[ "$(PEERS)" != 1 ] || deploy/deps long
	@PEERS=$(PEERS) tests/bench/run $(out) $(bin)
# The benchmarks of streaming only.
stream-bench: test-deps
	@$(MAKE) --no-print-directory all demo $(out)/tests/relay/relay
	@tests/bench/run $(out) $(bin) stream
.PHONY: stream-bench
# The benchmarks of the demo plant and of the paper's experiments on a GPU.
gpu-bench: test-deps
	@$(MAKE) --no-print-directory all demo $(out)/tests/bench/paper_bench $(out)/tests/bench/render_bench
	@$(bin)/plantcast-prep build/demo/plant.yaml
	@tests/bench/run $(out) $(bin) gpu
# Writes the tables and plots of tests/bench/RESULTS.md from the last `make bench PEERS=1`, stream-bench and gpu-bench. Keeps the text
# between the tables.
results:
	@tests/bench/results tests/bench $(wildcard build/bench.json build/stream-bench.json build/gpu-bench.json)
.PHONY: results

# Tests distances along surfaces with many seeds, and writes the worst errors to the accuracy table of tests/bench/RESULTS.md.
seeds ?= 40
accuracy: $(patsubst %,$(out)/tests/unit/%_test,surface accuracy contact)
	@mkdir -p $(build)/accuracy; for s in $$(seq $(seeds)); do for t in surface accuracy contact; do \
	    PLANTCAST_LONG=1 PLANTCAST_SEED=$$s \
	    $(out)/tests/unit/$${t}_test >$(build)/accuracy/$$t.$$s || { grep '^not ok' $(build)/accuracy/$$t.$$s; exit 1; }; \
	done; done
	@tests/bench/accuracy tests/bench/RESULTS.md $(build)/accuracy/surface.* $(build)/accuracy/accuracy.* $(build)/accuracy/contact.*
.PHONY: accuracy

# Compares the field with simulated heat conduction; results are in build/validation. write=1 also updates tests/validation.
validation: test-deps
	@$(MAKE) --no-print-directory all $(out)/tests/validation/compare
	@tests/validation/run $(out) $(bin) $(if $(write),--write)
.PHONY: validation

# Draws every kind of view for visual inspection into build/gallery/sheet.png. only="demo cookie_line viewer" draws some parts.
gallery: test-deps
	@deploy/deps gallery
	@$(MAKE) --no-print-directory all demo $(out)/tests/gallery/album
	@tests/gallery/run $(out) $(bin) $(only)
.PHONY: gallery

# Draws the golden pictures again, on llvmpipe. Inspect them before committing.
golden-update: $(out)/tests/gpu/golden_test
	@PLANTCAST_GL=egl-surfaceless GOLDEN_UPDATE=1 $<

.PHONY: check checked tests unit gpu scale

# `make fuzz seconds=600` runs each fuzzer in turn from its seeds in tests/fuzz/NAME, and writes inputs that fail to build/.
seconds ?= 60
fuzzers := $(patsubst tests/%.c,$(out)/tests/%,$(wildcard tests/fuzz/*_fuzz.c))
fuzz:
	@$(MAKE) --no-print-directory config=fuzz CC=clang build=$(build)/clang fuzzed
fuzzed: $(fuzzers)
	@for f in $(fuzzers); do seeds=$$(basename $$f _fuzz); mkdir -p $(out)/corpus/$$seeds; \
	    dict=tests/fuzz/$$seeds.dict; \
	    LSAN_OPTIONS=suppressions=tests/leaks.txt:print_suppressions=0 \
	    $$f -max_total_time=$(seconds) -timeout=10 $$([ -f $$dict ] && echo -dict=$$dict) -artifact_prefix=$(out)/ \
	    $(out)/corpus/$$seeds tests/fuzz/$$seeds || exit 1; done
$(out)/tests/fuzz/rvm_fuzz: pkg_libs += -lGLU
$(out)/tests/fuzz/tag_list_fuzz: $(out)/lib/match.a
$(out)/tests/fuzz/tag_list_fuzz: pkg_libs += -lminizip -lexpat
$(out)/tests/fuzz/%: $(out)/obj/tests/fuzz/%.o $(support) $(archives) $(out)/lib/prep.a $(out)/lib/import.a
	@mkdir -p $(@D); echo "  LINK $@"
	@$(CXX) $(ldflags) -fsanitize=fuzzer -o $@ $(filter %.o,$^) -Wl,--start-group $(filter %.a,$^) -Wl,--end-group $(pkg_libs) -lcmocka
.PHONY: fuzz fuzzed
