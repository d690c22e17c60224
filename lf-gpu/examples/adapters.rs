//! Lists the GPU adapters of this machine; exit status 1 if there is none.

use std::process::ExitCode;

fn main() -> ExitCode {
    let lines = lf_gpu::adapter_lines();
    for line in &lines {
        println!("{line}");
    }
    if lines.is_empty() {
        eprintln!("no Vulkan, Metal or Direct3D 12 adapter found");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}
