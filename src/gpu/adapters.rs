//! Which graphics adapters there are, and which one is taken.

use serde::Serialize;

use super::GpuError;

/// What kind of processor an adapter is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum AdapterKind {
    /// A card with memory of its own.
    Discrete,
    /// Part of the main processor, sharing its memory.
    Integrated,
    /// A share of one, in a virtual machine.
    Virtual,
    /// Unknown.
    Other,
    /// The main processor, pretending.
    Software,
}

impl AdapterKind {
    /// Whether it is known to be faster than the main processor: only then it is taken unasked.
    pub fn is_hardware(self) -> bool {
        matches!(self, Self::Discrete | Self::Integrated)
    }

    fn of(kind: wgpu::DeviceType) -> Self {
        match kind {
            wgpu::DeviceType::DiscreteGpu => Self::Discrete,
            wgpu::DeviceType::IntegratedGpu => Self::Integrated,
            wgpu::DeviceType::VirtualGpu => Self::Virtual,
            wgpu::DeviceType::Cpu => Self::Software,
            wgpu::DeviceType::Other => Self::Other,
        }
    }
}

/// A graphics adapter: what it is called, and what it can do.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AdapterEntry {
    /// Its name.
    pub name: String,
    /// What it is.
    pub kind: AdapterKind,
    /// The interface it is driven through.
    pub interface: String,
    /// Its driver, with the version.
    pub driver: String,
    /// The most pixels along a side of a texture: rays along a side of a tile.
    pub texture_side: u32,
    /// The most bytes of a buffer that shaders can reach at once.
    pub binding_bytes: u64,
    /// The most bytes of a buffer.
    pub buffer_bytes: u64,
    /// Whether it can peel layers ([`super::GpuMethod::Peel`]).
    pub peel: bool,
    /// Whether it can compute: scatter crossings ([`super::GpuMethod::Scatter`]) and measure distances ([`super::distances`]).
    pub scatter: bool,
    /// Whether it can time its passes.
    pub timestamps: bool,
}

/// Which adapter is wanted.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub enum Wanted {
    /// The best there is, the software one if need be.
    #[default]
    Any,
    /// The best discrete or integrated one.
    Hardware,
    /// The first whose name contains these words, upper and lower case alike.
    Named(String),
}

impl Wanted {
    fn takes(&self, entry: &AdapterEntry) -> bool {
        match self {
            Self::Any => true,
            Self::Hardware => entry.kind.is_hardware(),
            Self::Named(words) => entry.name.to_lowercase().contains(&words.to_lowercase()),
        }
    }

    /// The place in `entries` of the adapter that is taken: of those that fit and can do something, the one of the best kind.
    pub fn choose(&self, entries: &[AdapterEntry]) -> Option<usize> {
        let fit = |entry: &AdapterEntry| self.takes(entry) && (entry.scatter || entry.peel);
        (0..entries.len()).filter(|&n| fit(&entries[n])).min_by_key(|&n| entries[n].kind)
    }
}

impl std::fmt::Display for Wanted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Any => f.write_str("that can find the crossings of rays"),
            Self::Hardware => f.write_str("that is a graphics processor"),
            Self::Named(words) => write!(f, "named `{words}`"),
        }
    }
}

/// All adapters of this machine, in the order of its drivers. Takes tens of milliseconds.
pub fn adapters() -> Vec<AdapterEntry> {
    found().iter().map(entry).collect()
}

/// The adapter that is wanted.
pub(super) fn wanted(wanted: &Wanted) -> Result<(wgpu::Adapter, AdapterEntry), GpuError> {
    let mut adapters = found();
    let mut entries: Vec<AdapterEntry> = adapters.iter().map(entry).collect();
    match wanted.choose(&entries) {
        Some(n) => Ok((adapters.swap_remove(n), entries.swap_remove(n))),
        None => Err(GpuError::NoAdapter {
            wanted: wanted.to_string(),
            present: entries.into_iter().map(|entry| entry.name).collect(),
        }),
    }
}

fn found() -> Vec<wgpu::Adapter> {
    // wgpu panics where it was built without any interface (macOS: it would need another feature).
    if !wgpu::Instance::enabled_backend_features().contains(wgpu::Backends::VULKAN) {
        return Vec::new();
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor {
        backends: wgpu::Backends::VULKAN,
        // No validation layers: they print.
        flags: wgpu::InstanceFlags::empty(),
        ..wgpu::InstanceDescriptor::new_without_display_handle()
    });
    pollster::block_on(instance.enumerate_adapters(wgpu::Backends::VULKAN))
}

fn entry(adapter: &wgpu::Adapter) -> AdapterEntry {
    let (info, limits) = (adapter.get_info(), adapter.limits());
    let driver = [info.driver, info.driver_info].map(|words| words.trim().to_string());
    let down = adapter.get_downlevel_capabilities().flags;
    let compute = down.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS | wgpu::DownlevelFlags::VERTEX_STORAGE);
    let renders = |format| {
        let usages = adapter.get_texture_format_features(format).allowed_usages;
        usages.contains(wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING)
    };
    AdapterEntry {
        name: info.name,
        kind: AdapterKind::of(info.device_type),
        interface: info.backend.to_string(),
        driver: driver.join(" ").trim().to_string(),
        texture_side: limits.max_texture_dimension_2d,
        binding_bytes: limits.max_storage_buffer_binding_size,
        buffer_bytes: limits.max_buffer_size,
        peel: compute && renders(wgpu::TextureFormat::R32Uint) && renders(wgpu::TextureFormat::Depth32Float),
        scatter: down.contains(wgpu::DownlevelFlags::COMPUTE_SHADERS),
        timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str, kind: AdapterKind) -> AdapterEntry {
        AdapterEntry {
            name: name.into(),
            kind,
            interface: "vulkan".into(),
            driver: String::new(),
            texture_side: 16384,
            binding_bytes: 1 << 27,
            buffer_bytes: 1 << 31,
            peel: true,
            scatter: true,
            timestamps: false,
        }
    }

    #[test]
    fn the_best_kind_is_taken_and_software_only_when_it_is_asked_for() {
        use AdapterKind::{Discrete, Integrated, Software, Virtual};
        let both = [named("llvmpipe", Software), named("Iris", Integrated), named("Radeon", Discrete)];
        assert_eq!(Wanted::Any.choose(&both), Some(2));
        assert_eq!(Wanted::Hardware.choose(&both), Some(2));
        assert_eq!(Wanted::Named("IRIS".into()).choose(&both), Some(1));
        assert_eq!(Wanted::Named("GeForce".into()).choose(&both), None);
        let no_card = [named("llvmpipe", Software), named("virtio", Virtual)];
        assert_eq!(Wanted::Hardware.choose(&no_card), None);
        assert_eq!(Wanted::Any.choose(&no_card), Some(1));
        let idle = [AdapterEntry { peel: false, scatter: false, ..named("old", Discrete) }];
        assert_eq!(Wanted::Any.choose(&idle), None);
    }
}
