# SPDX-License-Identifier: GPL-3.0-or-later
# Running the tests. `make test` does all set-up; `make check` only builds and runs what needs no set-up.
test: test-deps
	@$(MAKE) --no-print-directory all $(unit_tests) $(gpu_tests)
	@tests/run $(out) $(bin) quick
test-long: test-deps
	@$(MAKE) --no-print-directory all $(unit_tests) $(gpu_tests)
	@tests/run $(out) $(bin) long
unit: $(unit_tests)
	@tests/run $(out) $(bin) unit
.PHONY: unit
