# SPDX-License-Identifier: GPL-3.0-or-later
# Packages, the demo plant, `make run`, install.
PORT  ?= 8080
PLANT ?= $(build)/demo/plant.yaml

deps:
	@deploy/deps build
test-deps:
	@deploy/deps build test

# A second make, because this one looked for libraries before they were installed.
run: deps
	@$(MAKE) --no-print-directory all $(filter $(build)/demo/%,$(PLANT))
	@exec deploy/run $(bin) $(PLANT) $(PORT)

# The demo plant is generated; preparing it again costs only a look at the files.
demo: $(build)/demo/plant.yaml $(bin)/plantcast-prep
	@$(bin)/plantcast-prep $(build)/demo/plant.yaml
$(build)/demo/plant.yaml: $(bin)/plantcast-demo
	@mkdir -p $(@D); $(bin)/plantcast-demo $(@D)

prefix ?= /usr/local
install: all
	install -d $(DESTDIR)$(prefix)/bin $(DESTDIR)$(prefix)/lib/plantcast $(DESTDIR)$(prefix)/share/plantcast
	install -m 755 $(programs) $(DESTDIR)$(prefix)/bin
	install -m 755 $(modules) $(DESTDIR)$(prefix)/lib/plantcast
	install -d $(DESTDIR)$(prefix)/libexec/plantcast
	$(if $(readers),install -m 755 $(readers) $(DESTDIR)$(prefix)/libexec/plantcast)
	[ ! -d $(bin)/plantcast-import-ifc ] || cp -r $(bin)/plantcast-import-ifc $(DESTDIR)$(prefix)/libexec/plantcast/
	cp -r clients/web $(DESTDIR)$(prefix)/share/plantcast/
