//! The device, and the few calls of wgpu that every client makes.

use std::sync::OnceLock;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindGroupLayout, BindingResource, Buffer,
    BufferDescriptor, BufferUsages, CommandEncoder, ComputePipeline, ComputePipelineDescriptor,
    Device, DeviceDescriptor, DeviceType, Extent3d, Features, Instance, InstanceDescriptor,
    MapMode, PipelineCompilationOptions, PollType, Queue, RequestAdapterOptions, ShaderModule,
    ShaderModuleDescriptor, ShaderSource, TexelCopyBufferInfo, TexelCopyBufferLayout, Texture,
    TextureDescriptor, TextureDimension, TextureFormat, TextureUsages, TextureView,
    TextureViewDescriptor, TextureViewDimension,
};

pub(crate) struct Gpu {
    pub(crate) device: Device,
    pub(crate) queue: Queue,
    /// The adapter and its driver, for the reader of a table.
    pub(crate) name: String,
    /// Whether the driver draws on the processor.
    pub(crate) software: bool,
}

/// The device of this process. Without one, this prints why, past the capture of `cargo test`.
pub(crate) fn gpu() -> Option<&'static Gpu> {
    static GPU: OnceLock<Result<Gpu, String>> = OnceLock::new();
    let open = || {
        let gpu = Gpu::open();
        let said = match &gpu {
            Ok(gpu) => format!("adapter: {}", gpu.name),
            Err(why) => format!("SKIPPED: the GPU clients: {why}"),
        };
        std::io::Write::write_all(&mut std::io::stderr(), format!("{said}\n").as_bytes())
            .expect("stderr");
        gpu
    };
    GPU.get_or_init(open).as_ref().ok()
}

impl Gpu {
    fn open() -> Result<Self, String> {
        let instance = Instance::new(InstanceDescriptor::new_without_display_handle_from_env());
        let adapter =
            pollster::block_on(instance.request_adapter(&RequestAdapterOptions::default()))
                .map_err(|error| format!("no Vulkan adapter: {error}"))?;
        let info = adapter.get_info();
        let name =
            format!("{} ({:?}; {} {})", info.name, info.device_type, info.driver, info.driver_info);
        let (device, queue) = pollster::block_on(adapter.request_device(&DeviceDescriptor {
            // Sums are blended in 32-bit floats.
            required_features: Features::FLOAT32_BLENDABLE,
            required_limits: adapter.limits(),
            ..DeviceDescriptor::default()
        }))
        .map_err(|error| format!("{name}: {error}"))?;
        Ok(Self { device, queue, name, software: info.device_type == DeviceType::Cpu })
    }

    /// Compiles files of WGSL that follow each other.
    pub(crate) fn module(&self, files: &[&str]) -> ShaderModule {
        let source = ShaderSource::Wgsl(files.concat().into());
        self.device.create_shader_module(ShaderModuleDescriptor { label: None, source })
    }

    pub(crate) fn uniform(&self, words: &[u32]) -> Buffer {
        self.filled(words, BufferUsages::UNIFORM)
    }

    pub(crate) fn storage(&self, words: &[u32]) -> Buffer {
        // A binding must not be empty, even if nothing is drawn.
        self.filled(if words.is_empty() { &[0; 24] } else { words }, BufferUsages::STORAGE)
    }

    fn filled(&self, words: &[u32], usage: BufferUsages) -> Buffer {
        let buffer = self.buffer(4 * words.len() as u64, usage | BufferUsages::COPY_DST);
        self.queue.write_buffer(&buffer, 0, bytemuck::cast_slice(words));
        buffer
    }

    /// A buffer of zeros that a shader writes, and that can be read back.
    pub(crate) fn output(&self, words: usize) -> Buffer {
        let copied = BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
        self.buffer(4 * words.max(1) as u64, BufferUsages::STORAGE | copied)
    }

    fn buffer(&self, size: u64, usage: BufferUsages) -> Buffer {
        self.device.create_buffer(&BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    }

    /// A texture that is drawn to, read by a later pass, and read back.
    pub(crate) fn target(&self, size: [u32; 2], format: TextureFormat) -> Texture {
        self.layers(size, 1, format)
    }

    /// The same with several layers.
    pub(crate) fn layers(
        &self,
        [width, height]: [u32; 2],
        depth_or_array_layers: u32,
        format: TextureFormat,
    ) -> Texture {
        self.device.create_texture(&TextureDescriptor {
            label: None,
            size: Extent3d { width, height, depth_or_array_layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::RENDER_ATTACHMENT
                | TextureUsages::TEXTURE_BINDING
                | TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    }

    pub(crate) fn bind(
        &self,
        layout: &BindGroupLayout,
        resources: &[(u32, BindingResource<'_>)],
    ) -> BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .map(|&(binding, ref resource)| BindGroupEntry { binding, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&BindGroupDescriptor {
            label: None,
            layout,
            entries: &entries,
        })
    }

    pub(crate) fn compute(
        &self,
        module: &ShaderModule,
        entry: &str,
        constants: &[(&str, f64)],
    ) -> ComputePipeline {
        self.device.create_compute_pipeline(&ComputePipelineDescriptor {
            label: None,
            layout: None,
            module,
            entry_point: Some(entry),
            compilation_options: PipelineCompilationOptions {
                constants,
                ..PipelineCompilationOptions::default()
            },
            cache: None,
        })
    }

    /// Runs a compute pass over this many workgroups.
    pub(crate) fn dispatch(
        &self,
        encoder: &mut CommandEncoder,
        pipeline: &ComputePipeline,
        resources: &[(u32, BindingResource<'_>)],
        [x, y]: [u32; 2],
    ) {
        let group = self.bind(&pipeline.get_bind_group_layout(0), resources);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
        pass.set_pipeline(pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.dispatch_workgroups(x, y, 1);
    }

    pub(crate) fn encoder(&self) -> CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default())
    }

    /// The words of a buffer, after these commands.
    pub(crate) fn read_buffer(&self, mut encoder: CommandEncoder, buffer: &Buffer) -> Vec<u32> {
        let size = buffer.size();
        let copy = self.buffer(size, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, size);
        self.queue.submit([encoder.finish()]);
        bytemuck::pod_collect_to_vec(&self.mapped(&copy))
    }

    /// The bytes of a texture row by row, without padding.
    pub(crate) fn read_texture(&self, texture: &Texture) -> Vec<u8> {
        self.read_layer(texture, 0)
    }

    /// The bytes of a layer of a texture.
    pub(crate) fn read_layer(&self, texture: &Texture, layer: u32) -> Vec<u8> {
        let bytes = texture.format().block_copy_size(None).expect("a format of one aspect");
        let tight = texture.width() * bytes;
        let padded = tight.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let length = u64::from(padded) * u64::from(texture.height());
        let copy = self.buffer(length, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let mut encoder = self.encoder();
        let layout =
            TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
        let mut from = texture.as_image_copy();
        from.origin.z = layer;
        let size = Extent3d { depth_or_array_layers: 1, ..texture.size() };
        let to = TexelCopyBufferInfo { buffer: &copy, layout };
        encoder.copy_texture_to_buffer(from, to, size);
        self.queue.submit([encoder.finish()]);
        let rows = self.mapped(&copy);
        rows.chunks(padded as usize).flat_map(|row| row[..tight as usize].to_vec()).collect()
    }

    fn mapped(&self, buffer: &Buffer) -> Vec<u8> {
        buffer.map_async(MapMode::Read, .., |mapped| mapped.expect("a buffer to read"));
        self.device.poll(PollType::wait_indefinitely()).expect("the device answers");
        buffer.get_mapped_range(..).expect("a mapped buffer").to_vec()
    }
}

/// The view of a whole texture.
pub(crate) fn view(texture: &Texture) -> TextureView {
    texture.create_view(&TextureViewDescriptor::default())
}

/// The view of one layer of a texture.
pub(crate) fn layer(texture: &Texture, layer: u32) -> TextureView {
    texture.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2),
        base_array_layer: layer,
        array_layer_count: Some(1),
        ..TextureViewDescriptor::default()
    })
}

/// The view of all layers of a texture, even if it is only one.
pub(crate) fn all_layers(texture: &Texture) -> TextureView {
    texture.create_view(&TextureViewDescriptor {
        dimension: Some(TextureViewDimension::D2Array),
        ..TextureViewDescriptor::default()
    })
}
