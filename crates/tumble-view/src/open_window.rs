//! Opening a window, also where there is none to be seen.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use macroquad::miniquad::conf::{LinuxBackend, Platform, WebGLVersion};
use macroquad::window::Conf;
use tumble_import::printable;

use crate::animation::write_gif;
use crate::failure::Failure;
use crate::gpu::{Background, Gpu, Renderer};
use crate::options::{Options, Task};
use crate::overlay::Writer;
use crate::page;
use crate::picture::{Easel, Output, write_png};
use crate::viewport::Viewport;
use crate::window;

/// Samples of each pixel in the window.
const SAMPLES: i32 = 4;

/// Opens a window and does in it what is to be done.
pub(crate) fn open(viewport: Viewport, task: Task<Output>, pace: f64, options: &Options) -> Result<(), Failure> {
    check_display()?;
    let size = options.view.size;
    let conf = Conf {
        window_title: "tumble".to_owned(),
        window_width: size.width as i32,
        window_height: size.height as i32,
        high_dpi: true,
        sample_count: SAMPLES,
        window_resizable: true,
        platform: Platform {
            linux_backend: backend(),
            linux_wm_class: "tumble-view",
            // The first has no indices of 32 bits.
            webgl_version: WebGLVersion::WebGL2,
            ..Platform::default()
        },
        ..Conf::default()
    };
    let options = options.clone();
    let done = Rc::new(RefCell::new(Ok(())));
    let in_window = Rc::clone(&done);
    let opened = Arc::new(AtomicBool::new(false));
    let is_open = Arc::clone(&opened);
    without_panic(&opened, move || {
        macroquad::Window::from_config(conf, async move {
            is_open.store(true, Ordering::Relaxed);
            let result = perform(viewport, task, pace, options).await;
            if let Err(failure) = &result {
                page::fail(&printable(&failure.to_string()).to_string());
            }
            *in_window.borrow_mut() = result;
        });
    })?;
    done.replace(Ok(()))
}

async fn perform(mut viewport: Viewport, task: Task<Output>, pace: f64, options: Options) -> Result<(), Failure> {
    let size = options.view.size;
    let mut gpu = Gpu::of_the_window();
    let mut renderer = Renderer::new(&mut gpu, &viewport.playback.bodies)?;
    let writer = Writer::new().map_err(Failure::Running)?;
    match task {
        Task::Screenshot { file, at } if !page::IS_THERE => {
            viewport.playback.go_to(at);
            let easel = Easel::new(size, Background::Gradient);
            let status = window::status(viewport.playback.time(), pace, pace);
            write_png(file, &easel.draw(&mut viewport, (&mut gpu, &mut renderer, &writer), status))
        }
        Task::Animation { file, from, frames, fps } if !page::IS_THERE => {
            let easel = Easel::new(size, Background::Plain);
            let mut images = Vec::new();
            for frame in 0..frames {
                viewport.playback.go_to(from + pace * f64::from(frame) / f64::from(fps));
                let status = window::status(viewport.playback.time(), pace, pace);
                images.push(easel.draw(&mut viewport, (&mut gpu, &mut renderer, &writer), status));
            }
            write_gif(file, &images, fps)
        }
        _ => window::show(viewport, (gpu, renderer, writer), pace, options).await,
    }
}

/// X11 where there is a choice; it is what the window library has used longest.
fn backend() -> LinuxBackend {
    if is_set("DISPLAY") { LinuxBackend::X11Only } else { LinuxBackend::WaylandOnly }
}

fn is_set(variable: &str) -> bool {
    std::env::var_os(variable).is_some_and(|value| !value.is_empty())
}

fn check_display() -> Result<(), Failure> {
    if cfg!(target_os = "linux") && !is_set("DISPLAY") && !is_set("WAYLAND_DISPLAY") {
        return Err(Failure::Running(
            "there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set; without a screen, run it under xvfb-run -a".to_owned(),
        ));
    }
    Ok(())
}

/// The window library panics where it finds no display or no OpenGL. That is no fault of the
/// program, and is reported in a line; a panic after the window has opened is one of ours, and goes
/// on.
fn without_panic(opened: &Arc<AtomicBool>, open: impl FnOnce()) -> Result<(), Failure> {
    let usual = std::panic::take_hook();
    let is_open = Arc::clone(opened);
    std::panic::set_hook(Box::new(move |panic| {
        if is_open.load(Ordering::Relaxed) {
            usual(panic);
        }
    }));
    let result = catch_unwind(AssertUnwindSafe(open));
    result.map_err(|panic| {
        if opened.load(Ordering::Relaxed) {
            std::panic::resume_unwind(panic);
        }
        let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        let said = said.unwrap_or("for an unknown reason").replace('\n', " ");
        Failure::Running(format!("no window can be opened, or it has no OpenGL: {said}"))
    })
}
