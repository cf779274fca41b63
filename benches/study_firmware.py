"""Does a model run on a microcontroller as it runs here? `python benches/study_firmware.py`.

The render step is built for a Cortex-M7 (an Arm processor without an operating system), linked with a program
in C, and run on one that QEMU emulates: every torque along a motion is compared with `Renderer`'s, by bits.
Needs of Debian gcc-arm-none-eabi, libnewlib-arm-none-eabi and qemu-system-arm.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import knobcam as kc
from knobcam.render.convert import convert

ROOT = Path(__file__).parents[1]
TARGET = "thumbv7em-none-eabihf"
LIBRARY = ROOT / "dist" / "libknobstep.a"
CPU = ("-mcpu=cortex-m7", "-mthumb", "-mfloat-abi=hard", "-mfpu=fpv5-d16")
BOARD = ("qemu-system-arm", "-M", "mps2-an500", "-nographic", "-semihosting", "-kernel")
HIDDEN = ("backlash", "compliance", "presliding", "position_friction", "end_stop", "stribeck")
STEPS, RATE_HZ = 2500, 5000.0
FILLED = 0xA5  # what nobody wrote over

START = """\
#include <stdint.h>
extern uint32_t top_of_stack, data_in_flash, data_begin, data_end, bss_begin, bss_end;
int main(void);
void initialise_monitor_handles(void);
void exit(int);
void _init(void) {}
void _fini(void) {}
static void reset(void) {
    *(volatile uint32_t *)0xE000ED88 |= 0xF << 20; /* the floating-point unit */
    __asm volatile("dsb; isb");
    uint32_t *from = &data_in_flash;
    for (uint32_t *to = &data_begin; to < &data_end;) *to++ = *from++;
    for (uint32_t *to = &bss_begin; to < &bss_end;) *to++ = 0;
    initialise_monitor_handles();
    exit(main());
}
static void stop(void) { for (;;) {} }
__attribute__((section(".vectors"), used)) void *const vectors[16] =
    {&top_of_stack, (void *)reset, stop, stop, stop, stop, stop};
"""

PLACES = """\
MEMORY {
  FLASH (rx) : ORIGIN = 0x00000000, LENGTH = 4M
  RAM (rwx) : ORIGIN = 0x20000000, LENGTH = 4M
}
ENTRY(reset)
SECTIONS {
  .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) . = ALIGN(8); } > FLASH
  .ARM.exidx : { *(.ARM.exidx*) } > FLASH
  data_in_flash = LOADADDR(.data);
  .data : { data_begin = .; *(.data*) . = ALIGN(8); data_end = .; } > RAM AT> FLASH
  .bss : { bss_begin = .; *(.bss*) *(COMMON) . = ALIGN(8); bss_end = .; end = .; } > RAM
  top_of_stack = ORIGIN(RAM) + LENGTH(RAM);
}
"""

MAIN = """\
#include <stdio.h>
#include "knob.h"
#include "rows.h"

static double memory[KNOB_MEMORY / sizeof(double)];
int main(void) {
    char why[200];
    unsigned char *bytes = (unsigned char *)memory;
    unsigned off = 0, used = 0;
    for (size_t i = 0; i < sizeof memory; i++) bytes[i] = %(filled)d;
    knobcam_memory(memory, sizeof memory);
    knobcam_knob *knob = knobcam_new(KNOB_MODEL, KNOB_RATE_HZ, 0, why, sizeof why);
    if (knob == NULL) { puts(why); return 1; }
    for (size_t i = 0; i < sizeof memory; i++) used += bytes[i] != %(filled)d;
    for (int i = 0; i < %(steps)d; i++) {
        union { double torque; unsigned long long bits; } one;
        one.torque = knobcam_step(knob, rows[i][0], rows[i][1], rows[i][2]);
        off += one.bits != right[i];
    }
    printf("%%u %%u %%u %%d\\n", off, used, (unsigned)sizeof memory, knobcam_fault(knob));
    return 0;
}
"""


def rows(motion: np.ndarray, torque: np.ndarray) -> str:
    """Return a motion and the torques of `Renderer` as constants of C, exact."""
    moved = ",\n".join("{" + ", ".join(float(x).hex() for x in row) + "}" for row in motion)
    bits = ",\n".join(f"{word}ull" for word in torque.view(np.uint64))
    return (
        f"static const double rows[{len(motion)}][3] = {{{moved}}};\n"
        f"static const unsigned long long right[{len(torque)}] = {{{bits}}};\n"
    )


def run(name: str, model: kc.Model, folder: Path) -> None:
    """Run one model on the emulated processor, and print how it did."""
    track = kc.motion("hand", STEPS / RATE_HZ)
    motion = np.stack([track.theta, track.omega, track.alpha], axis=1)[:STEPS]
    torque = np.asarray(kc.Renderer(model, RATE_HZ).along(*motion.T.copy()))
    convert(model, "c", motion=track).save(folder / "knob.h")
    (folder / "rows.h").write_text(rows(motion, torque))
    link = ["arm-none-eabi-gcc", *CPU, "-O2", "-nostartfiles", "--specs=rdimon.specs", "-T", "places.ld"]
    link += ["start.c", "main.c", str(LIBRARY), "-o", "knob.elf"]
    subprocess.run(link, cwd=folder, check=True, capture_output=True)
    sizes = subprocess.run(
        ["arm-none-eabi-size", "knob.elf"], cwd=folder, check=True, capture_output=True, text=True
    )
    flash = int(re.findall(r"\d+", sizes.stdout)[0])
    told = subprocess.run(
        [*BOARD, "knob.elf"], cwd=folder, check=True, capture_output=True, text=True, timeout=300
    )
    off, used, given, fault = map(int, told.stdout.split())
    print(
        f"{name}: {off} of {len(motion)} torques differ, fault {fault}; written {used} of {given} bytes, "
        f"the program with its motion {flash / 1000.0:.0f} kB",
        flush=True,
    )


if __name__ == "__main__":
    subprocess.run([sys.executable, "dev.py", "firmware", TARGET], cwd=ROOT, check=True)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "start.c").write_text(START)
        (folder / "places.ld").write_text(PLACES)
        (folder / "main.c").write_text(MAIN % {"filled": FILLED, "steps": STEPS})
        for name in kc.KNOBS:
            run(name, kc.Model.load(name), folder)
        for name in HIDDEN:
            run(name, kc.hiding("knob5", name), folder)
