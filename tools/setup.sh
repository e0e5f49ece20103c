# SPDX-License-Identifier: GPL-3.0-or-later
# shellcheck shell=bash
# What the checkout needs, by the names of Debian 12 and Ubuntu, and `need GROUP...`, which installs what is missing.
# Sourced by ./dev.

declare -A packages=(
  [build]="g++ cmake ninja-build ccache libembree-dev libtbb-dev libopenexr-dev libpng-dev libturbojpeg0-dev libopenimageio-dev
    libdraco-dev libmeshoptimizer-dev libwebp-dev libsimdjson-dev libcli11-dev nlohmann-json3-dev libfmt-dev libgtest-dev libboost-math-dev libeigen3-dev python3"
  [blender]="blender python3-numpy python3-pil python3-openimageio fonts-dejavu-core patchelf"
  [test]="git valgrind clang libclang-rt-dev clang-tidy shellcheck python3-venv gnuplot-nox chromium chromium-driver python3-selenium
    xvfb libgl1-mesa-dri"
)

# Ubuntu has Chromium as a snap alone, which must be installed by hand for the tests of the report's page
! grep -qs '^ID=ubuntu' /etc/os-release || packages[test]=${packages[test]/chromium chromium-driver/}

declare -A seen_groups=()

# Costs a few hundredths of a second where nothing is missing, and asks each group once.
need() {
  local group wanted=() missing=() sudo=()
  for group in "$@"; do
    # shellcheck disable=SC2206 # words are wanted
    [ -n "${seen_groups[$group]:-}" ] || wanted+=(${packages[$group]})
    seen_groups[$group]=1
  done
  [ -z "${BLENDER:-}" ] || wanted=("${wanted[@]/#%blender/}") # the caller brings another Blender
  [ ${#wanted[@]} -gt 0 ] || return 0

  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    need_without_apt
    return
  fi
  mapfile -t missing < <(comm -23 <(printf '%s\n' "${wanted[@]}" | grep . | sort -u) \
    <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2>/dev/null | sed -n 's/^installed //p' | sort -u))
  [ ${#missing[@]} -gt 0 ] || return 0

  if [ "$(id -u)" != 0 ]; then
    # sudo may ask for a password only where somebody can answer
    if command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
      sudo=(sudo)
    else
      die "these packages are missing and may not be installed from here: ${missing[*]}
     As root: apt-get install --no-install-recommends ${missing[*]}"
    fi
  fi
  say "installing with ${sudo[*]} apt-get: ${missing[*]}"
  "${sudo[@]}" apt-get update -q >&2
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "${missing[@]}" >&2 ||
    die "apt-get could not install: ${missing[*]}"
}

# Another distribution: what can be checked is checked, and CMake names the library that it does not find.
need_without_apt() {
  local command missing=()
  # shellcheck disable=SC2154 # ./dev sets python
  for command in c++ cmake ninja "$python" "${BLENDER:-blender}"; do
    command -v "$command" >/dev/null || missing+=("$command")
  done
  [ ${#missing[@]} -eq 0 ] || die "not found: ${missing[*]}. This is no Debian or Ubuntu: install the packages that
     README.md lists for your distribution ('Other Linux distributions'), then run this again."
}
