//! What an operating system does for a program, where there is none.

use core::ffi::c_void;
use talc::TalcLock;
use talc::source::Manual;

/// The memory that the program gave.
#[global_allocator]
static MEMORY: TalcLock<spin::Mutex<()>, Manual> = TalcLock::new(Manual);

/// Adds to it.
///
/// # Safety
/// `memory` is null or has `bytes` bytes, which nobody else uses from now on.
pub unsafe fn take(memory: *mut c_void, bytes: usize) {
    if !memory.is_null() {
        // SAFETY: as the caller vouches. What is too little to keep books in is left alone.
        let _ = unsafe { MEMORY.lock().claim(memory.cast(), bytes) };
    }
}

/// Bytes of it that are left.
pub fn left() -> usize {
    MEMORY.lock().counters().available_bytes
}

/// Not reached: a model for which there is too little memory is refused, no step takes any, and none panics. If it ever is,
/// a program ends, and the watchdog of a firmware sees it.
#[panic_handler]
fn stopped(_: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(not(target_os = "none"))]
    {
        unsafe extern "C" {
            safe fn abort() -> !;
        }
        abort()
    }
    #[cfg(target_os = "none")]
    loop {
        core::hint::spin_loop();
    }
}

/// What the precompiled part of Rust's own library names on computers that can unwind; nothing here does, so nobody calls it.
#[cfg(not(target_os = "none"))]
#[unsafe(no_mangle)]
extern "C" fn rust_eh_personality() {}
