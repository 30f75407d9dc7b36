# SPDX-License-Identifier: GPL-3.0-or-later
# Packages, the demo plant, `make run`, install.
deps:
	@deploy/deps build
test-deps:
	@deploy/deps build test
