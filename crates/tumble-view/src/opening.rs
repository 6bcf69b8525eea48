//! Opening a window, also where there is none to be seen.

use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::rc::Rc;
use std::sync::{Arc, Mutex, PoisonError};

use macroquad::miniquad::conf::{LinuxBackend, Platform};
use macroquad::window::Conf;

use crate::animation::{MOST_BYTES, write_gif};
use crate::failure::Failure;
use crate::gpu::{Background, Gpu, Renderer};
use crate::options::{Options, Size, Task, frame_count};
use crate::overlay::Writer;
use crate::picture::{Easel, write_png};
use crate::stage::Stage;
use crate::window;

/// Samples of each pixel in the window.
const SAMPLES: i32 = 4;

/// Opens a window and does in it what is to be done.
pub(crate) fn open(stage: Stage, task: Task, options: &Options) -> Result<(), Failure> {
    check_display()?;
    let size = options.view.size;
    let conf = Conf {
        window_title: "tumble".to_owned(),
        window_width: size.width as i32,
        window_height: size.height as i32,
        high_dpi: true,
        sample_count: SAMPLES,
        window_resizable: true,
        platform: Platform { linux_backend: backend(), linux_wm_class: "tumble-view", ..Platform::default() },
        ..Conf::default()
    };
    let (paused, speed) = (options.paused, options.speed);
    let done = Rc::new(RefCell::new(Ok(())));
    let in_window = Rc::clone(&done);
    let opened = Arc::new(Mutex::new(false));
    let is_open = Arc::clone(&opened);
    without_panic(opened, move || {
        macroquad::Window::from_config(conf, async move {
            *is_open.lock().unwrap_or_else(PoisonError::into_inner) = true;
            let result = perform(stage, task, size, paused, speed).await;
            *in_window.borrow_mut() = result;
        });
    })?;
    done.replace(Ok(()))
}

async fn perform(mut stage: Stage, task: Task, size: Size, paused: bool, speed: Option<f64>) -> Result<(), Failure> {
    let mut gpu = Gpu::of_the_window();
    let mut renderer = Renderer::new(&mut gpu, &stage.playback.bodies)?;
    let writer = Writer::new().map_err(Failure::Running)?;
    let pace = speed.unwrap_or_else(|| stage.playback.pace());
    match task {
        Task::Window => window::show(stage, (gpu, renderer, writer), paused, speed).await,
        Task::Screenshot { file, at } => {
            stage.playback.go_to(at);
            let easel = Easel::new(size, Background::Gradient);
            let status = window::status(stage.playback.time(), pace, pace);
            write_png(&file, &easel.draw(&mut stage, (&mut gpu, &mut renderer, &writer), status))
        }
        Task::Animation { file, from, duration, fps } => {
            let easel = Easel::new(size, Background::Plain);
            let frames = frame_count(duration / pace, fps)?;
            animate(&mut stage, (&mut gpu, &mut renderer, &writer), (&easel, size), (frames, from, pace), fps, &file)
        }
    }
}

/// Draws all pictures of an animation and writes them.
fn animate(
    stage: &mut Stage,
    (gpu, renderer, writer): (&mut Gpu, &mut Renderer, &Writer),
    (easel, size): (&Easel, Size),
    (frames, from, pace): (u32, f64, f64),
    fps: u16,
    file: &Path,
) -> Result<(), Failure> {
    let bytes = 3 * u64::from(size.width) * u64::from(size.height) * u64::from(frames);
    if bytes > MOST_BYTES {
        let problem = format!("--animation: {frames} pictures of this size take {bytes} bytes, more than {MOST_BYTES}");
        return Err(Failure::Input(problem));
    }
    let mut images = Vec::new();
    for frame in 0..frames {
        stage.playback.go_to(from + pace * f64::from(frame) / f64::from(fps));
        let status = window::status(stage.playback.time(), pace, pace);
        images.push(easel.draw(stage, (gpu, renderer, writer), status));
    }
    write_gif(file, &images, fps)
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

/// The window library panics where it finds no display or no OpenGL. That is no fault of the program, and is told in a line; a panic
/// after the window has opened is one of ours, and goes on.
fn without_panic(opened: Arc<Mutex<bool>>, open: impl FnOnce()) -> Result<(), Failure> {
    let usual = std::panic::take_hook();
    let is_open = Arc::clone(&opened);
    std::panic::set_hook(Box::new(move |panic| {
        if *is_open.lock().unwrap_or_else(PoisonError::into_inner) {
            usual(panic);
        }
    }));
    let result = catch_unwind(AssertUnwindSafe(open));
    result.or_else(|panic| {
        if *opened.lock().unwrap_or_else(PoisonError::into_inner) {
            std::panic::resume_unwind(panic);
        }
        let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        let said = said.unwrap_or("for an unknown reason").replace('\n', " ");
        Err(Failure::Running(format!("no window can be opened, or it has no OpenGL: {said}")))
    })
}
