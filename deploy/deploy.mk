# SPDX-License-Identifier: GPL-3.0-or-later
# Packages, the demo plant, `make run`, install.
PORT  ?= 8080
PLANT ?= $(build)/demo/plant.yaml

deps:
	@deploy/deps build
test-deps:
	@deploy/deps build test

# A second make, because this one looked for libraries before they were installed. setpriv ends deploy/run with make, even a killed make.
run: deps
	@deploy/compile $(build)/compile.log $(MAKE) --no-print-directory $(jobs) all $(filter $(build)/demo/%,$(PLANT))
	@exec setpriv --pdeathsig TERM deploy/run $(bin) $(PLANT) $(PORT)

# A copy of the demo plant, prepared. Repeated preparation only compares files.
demo_files := $(addprefix deploy/demo/,plant.yaml plant.glb tags.csv)
demo: $(build)/demo/plant.yaml $(bin)/plantcast-prep
	@$(bin)/plantcast-prep $(build)/demo/plant.yaml
$(build)/demo/plant.yaml: $(demo_files)
	@mkdir -p $(@D); cp $^ $(@D)

prefix ?= /usr/local
root   := $(DESTDIR)$(prefix)
units  := $(wildcard deploy/systemd/*.service deploy/systemd/*.socket deploy/systemd/*.timer)
units  := $(if $(video),$(units),$(filter-out %/plantcast-video@.service,$(units)))
install: all
	install -d $(root)/bin $(root)/lib/plantcast $(root)/libexec/plantcast $(root)/share/plantcast $(root)/share/doc/plantcast
	install -m 755 $(filter-out $(bin)/plantcast-sim,$(programs)) $(root)/bin
	$(if $(video),install -m 755 $(video) $(root)/bin)
	install -m 755 $(scripts) $(root)/bin
	install -m 755 $(modules) deploy/systemd/certbot-hook deploy/systemd/renew-certificate deploy/systemd/kiosk $(root)/lib/plantcast
	install -m 755 deploy/prometheus/add $(root)/lib/plantcast/prometheus-add
	$(if $(readers),install -m 755 $(readers) $(root)/libexec/plantcast)
	[ ! -f $(bin)/plantcast-import-ifc/ifc.mjs ] || cp -r $(bin)/plantcast-import-ifc $(root)/libexec/plantcast/
	install -m 644 deploy/LICENSE $(root)/share/doc/plantcast
	cp -r $(bin)/web $(root)/share/plantcast/
	cp -r deploy/prometheus deploy/grafana deploy/proxy deploy/ansible $(root)/share/doc/plantcast
	deploy/copy_pages $(root)/share/doc/plantcast
	install -d $(root)/lib/systemd/system $(root)/lib/sysusers.d $(root)/lib/tmpfiles.d $(root)/share/bash-completion/completions
	for unit in $(units); do \
	    sed 's|/usr/bin/plantcast|$(prefix)/bin/plantcast|g; s|/usr/lib/plantcast|$(prefix)/lib/plantcast|g' $$unit \
	        >$(root)/lib/systemd/system/$${unit##*/} || exit 1; \
	done
	install -m 644 deploy/systemd/sysusers.conf $(root)/lib/sysusers.d/plantcast.conf
	install -m 644 deploy/systemd/tmpfiles.conf $(root)/lib/tmpfiles.d/plantcast.conf
	install -m 644 deploy/completion $(root)/share/bash-completion/completions/plantcast
# The demo plant and its simulator.
install-demo: all
	install -d $(root)/bin $(root)/share/plantcast/demo
	install -m 755 $(bin)/plantcast-sim $(root)/bin
	install -m 644 $(demo_files) $(root)/share/plantcast/demo
# Debian packages of the committed files.
deb: clients/web/vendor/uPlot.js $(bin)/plantcast-import-ifc/ifc.mjs
	@deploy/deb $(build)/deb "$(COMMIT)"
# An archive that installs the packages without a network (SIGN=KEY.pem signs it), and a container image. Both need root and a mirror.
suite := $(shell . /etc/os-release && echo $$VERSION_CODENAME)
debs  := $(build)/deb
bundle: WITH ?= plantcast-h264
bundle:
	@WITH="$(WITH)" deploy/bundle $(debs) $(build)/plantcast-bundle-$(suite).tar $(suite) $(SIGN)
image:
	@WITH="$(WITH)" deploy/image $(debs) $(build)/plantcast-image-$(suite).tar $(suite)
# Tests of these packages, the archive and the image, in chroots without a network.
test-deploy:
	@deploy/test/run $(debs) $(build)/plantcast-bundle-$(suite).tar $(build)/plantcast-image-$(suite).tar $(suite)
.PHONY: install-demo deb bundle image test-deploy
