//! A render pass, described by what the clients vary.

use crate::bugs::Bug;
use crate::device::Gpu;
use std::ops::Range;
use wgpu::{
    BindingResource, BlendComponent, BlendFactor, BlendOperation, BlendState, Color,
    ColorTargetState, ColorWrites, CommandEncoder, CompareFunction, DepthStencilState,
    FragmentState, LoadOp, MultisampleState, Operations, PipelineCompilationOptions,
    PrimitiveState, PrimitiveTopology, RenderPassColorAttachment, RenderPassDepthStencilAttachment,
    RenderPassDescriptor, RenderPipeline, RenderPipelineDescriptor, ShaderModule, StoreOp,
    TextureFormat, TextureView, VertexState,
};

/// A color target, how it is cleared, and whether fragments are added up in it.
pub(crate) struct Target<'a> {
    pub(crate) view: &'a TextureView,
    pub(crate) clear: [f64; 4],
    pub(crate) adds: bool,
}

/// A target whose fragments replace each other.
pub(crate) fn fresh(view: &TextureView, clear: f64) -> Target<'_> {
    Target { view, clear: [clear; 4], adds: false }
}

/// What is drawn: quads, one an instance; a triangle over the screen; or points.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Draws {
    Quads,
    Screen,
    Points,
}

pub(crate) struct Pass<'a> {
    pub(crate) draws: Draws,
    pub(crate) vertex: &'a str,
    pub(crate) fragment: &'a str,
    pub(crate) targets: &'a [Target<'a>],
    /// The depth buffer, and which fragments pass.
    pub(crate) depth: Option<(&'a TextureView, CompareFunction)>,
    pub(crate) resources: &'a [(u32, BindingResource<'a>)],
    /// The splats or points.
    pub(crate) items: Range<u32>,
}

/// Encodes a pass.
pub(crate) fn run(
    gpu: &Gpu,
    encoder: &mut CommandEncoder,
    module: &ShaderModule,
    bug: Bug,
    pass: &Pass<'_>,
) {
    let pipeline = pipeline(gpu, module, bug, pass);
    let group = gpu.bind(&pipeline.get_bind_group_layout(0), pass.resources);
    let attachments: Vec<_> = pass.targets.iter().map(attachment).collect();
    let depth_stencil_attachment = pass.depth.map(|(view, compare)| {
        let reversed = matches!(compare, CompareFunction::Greater | CompareFunction::GreaterEqual);
        let load = LoadOp::Clear(if reversed { 0.0 } else { 1.0 });
        let depth_ops = Some(Operations { load, store: StoreOp::Store });
        RenderPassDepthStencilAttachment { view, depth_ops, stencil_ops: None }
    });
    let mut drawn = encoder.begin_render_pass(&RenderPassDescriptor {
        color_attachments: &attachments,
        depth_stencil_attachment,
        ..RenderPassDescriptor::default()
    });
    drawn.set_pipeline(&pipeline);
    drawn.set_bind_group(0, &group, &[]);
    match pass.draws {
        Draws::Quads => drawn.draw(0..4, pass.items.clone()),
        Draws::Screen => drawn.draw(0..3, 0..1),
        Draws::Points => drawn.draw(pass.items.clone(), 0..1),
    }
}

fn attachment<'a>(target: &Target<'a>) -> Option<RenderPassColorAttachment<'a>> {
    let [r, g, b, a] = target.clear;
    let ops = Operations { load: LoadOp::Clear(Color { r, g, b, a }), store: StoreOp::Store };
    Some(RenderPassColorAttachment {
        view: target.view,
        depth_slice: None,
        resolve_target: None,
        ops,
    })
}

fn pipeline(gpu: &Gpu, module: &ShaderModule, bug: Bug, pass: &Pass<'_>) -> RenderPipeline {
    let constants = bug.constants();
    let compilation_options = PipelineCompilationOptions {
        constants: &constants,
        ..PipelineCompilationOptions::default()
    };
    let (src_factor, dst_factor) = (BlendFactor::One, BlendFactor::One);
    let sum = BlendComponent { src_factor, dst_factor, operation: BlendOperation::Add };
    let state = |target: &Target<'_>| {
        let blend = target.adds.then_some(BlendState { color: sum, alpha: sum });
        let format = format(target.view);
        Some(ColorTargetState { format, blend, write_mask: ColorWrites::ALL })
    };
    let targets: Vec<_> = pass.targets.iter().map(state).collect();
    let topology = match pass.draws {
        Draws::Quads => PrimitiveTopology::TriangleStrip,
        Draws::Screen => PrimitiveTopology::TriangleList,
        Draws::Points => PrimitiveTopology::PointList,
    };
    let depth_stencil = pass.depth.map(|(view, compare)| DepthStencilState {
        format: format(view),
        depth_write_enabled: Some(true),
        depth_compare: Some(compare),
        stencil: wgpu::StencilState::default(),
        bias: wgpu::DepthBiasState::default(),
    });
    gpu.device.create_render_pipeline(&RenderPipelineDescriptor {
        label: Some(pass.fragment),
        layout: None,
        vertex: VertexState {
            module,
            entry_point: Some(pass.vertex),
            compilation_options: compilation_options.clone(),
            buffers: &[],
        },
        primitive: PrimitiveState { topology, ..PrimitiveState::default() },
        depth_stencil,
        multisample: MultisampleState::default(),
        fragment: Some(FragmentState {
            module,
            entry_point: Some(pass.fragment),
            compilation_options,
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    })
}

fn format(view: &TextureView) -> TextureFormat {
    view.texture().format()
}
