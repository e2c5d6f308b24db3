//! The way through a document, each step looked at before it is taken.
//!
//! The traversal of the `gltf` crate panics where an index leads nowhere and where a word is none that the specification knows. Its
//! validation would refuse such documents, but also meshes that are sound: those without bounds of their positions, and those that require
//! an extension on looks. So a document is not validated as a whole; whatever could panic is asked for here alone, and this gives an error
//! instead.

use gltf::accessor::{DataType, Dimensions};
use gltf::json;
use gltf::json::validation::Checked::{Invalid, Valid};
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Image, Material, Mesh, Node, Scene, Semantic, Texture, buffer};

use super::super::error::{FileError, FileProblem};

/// The problem of an index that leads nowhere.
pub(super) fn missing(index: usize, count: usize, what: &'static str) -> FileProblem {
    FileProblem::IndexOutOfRange { index: index as i64, count, what }
}

fn nth<T>(mut list: impl ExactSizeIterator<Item = T>, index: usize, what: &'static str) -> Result<T, FileProblem> {
    let count = list.len();
    list.nth(index).ok_or_else(|| missing(index, count, what))
}

/// The scene that is to be shown: the default one, else the first; `None` when there is none.
pub(super) fn scene(document: &Document) -> Result<Option<Scene<'_>>, FileError> {
    match document.as_json().scene {
        Some(scene) => nth(document.scenes(), scene.value(), "scenes")
            .map(Some)
            .map_err(|problem| FileError::item("scene", problem)),
        None => Ok(document.scenes().next()),
    }
}

/// The numbers of the nodes at the top of a scene, in order; they may lead nowhere.
pub(super) fn tops(document: &Document, scene: &Scene<'_>) -> Vec<usize> {
    document.as_json().scenes.get(scene.index()).map_or_else(Vec::new, |scene| numbers(&scene.nodes))
}

/// The numbers of a node's children, in order; they may lead nowhere.
pub(super) fn children(document: &Document, node: &Node<'_>) -> Vec<usize> {
    let of = |node: &json::scene::Node| node.children.as_deref().map_or_else(Vec::new, numbers);
    document.as_json().nodes.get(node.index()).map_or_else(Vec::new, of)
}

fn numbers<T>(list: &[json::Index<T>]) -> Vec<usize> {
    list.iter().map(json::Index::value).collect()
}

/// The node of a number.
pub(super) fn node(document: &Document, index: usize) -> Result<Node<'_>, FileProblem> {
    nth(document.nodes(), index, "nodes")
}

/// The number of a node's mesh, which may lead nowhere, and whether a skin moves it.
pub(super) fn mesh_of(document: &Document, node: &Node<'_>) -> Option<(usize, bool)> {
    let node = document.as_json().nodes.get(node.index())?;
    Some((node.mesh?.value(), node.skin.is_some()))
}

/// The mesh of a number.
pub(super) fn mesh(document: &Document, index: usize) -> Result<Mesh<'_>, FileProblem> {
    nth(document.meshes(), index, "meshes")
}

/// The accessor of a number.
pub(super) fn accessor(document: &Document, index: usize) -> Result<Accessor<'_>, FileProblem> {
    nth(document.accessors(), index, "accessors")
}

/// The type of the numbers of an accessor.
pub(super) fn data_type(document: &Document, accessor: &Accessor<'_>) -> Result<DataType, FileProblem> {
    match document.as_json().accessors.get(accessor.index()).map(|json| &json.component_type) {
        Some(Valid(_)) => Ok(accessor.data_type()),
        Some(Invalid) | None => Err(FileProblem::syntax("a component type", "another value")),
    }
}

/// How many numbers a value of an accessor has; `None` where that is no word of the specification.
pub(super) fn dimensions(document: &Document, accessor: &Accessor<'_>) -> Option<Dimensions> {
    let json = document.as_json().accessors.get(accessor.index())?;
    matches!(json.type_, Valid(_)).then(|| accessor.dimensions())
}

/// The sparse part of an accessor, whose numbers of views may lead nowhere.
pub(super) fn sparse<'a>(
    document: &'a Document,
    accessor: &Accessor<'_>,
) -> Option<&'a json::accessor::sparse::Sparse> {
    document.as_json().accessors.get(accessor.index())?.sparse.as_ref()
}

/// The number of the view that an accessor reads from, which may lead nowhere.
pub(super) fn view_of(document: &Document, accessor: &Accessor<'_>) -> Option<usize> {
    Some(document.as_json().accessors.get(accessor.index())?.buffer_view?.value())
}

/// The view of a number.
pub(super) fn view(document: &Document, index: usize) -> Result<buffer::View<'_>, FileProblem> {
    let json = document.as_json();
    let view = json.buffer_views.get(index).ok_or_else(|| missing(index, json.buffer_views.len(), "buffer views"))?;
    // The crate looks at the buffer of every view that it hands out.
    if view.buffer.value() >= json.buffers.len() {
        return Err(missing(view.buffer.value(), json.buffers.len(), "buffers"));
    }
    nth(document.views(), index, "buffer views")
}

/// The texture of the base colour of a material: its number, which may lead nowhere, and the set of coordinates that it takes.
pub(super) fn base_texture(document: &Document, material: &Material<'_>) -> Option<(usize, u32)> {
    let json = document.as_json().materials.get(material.index()?)?;
    let texture = json.pbr_metallic_roughness.base_color_texture.as_ref()?;
    Some((texture.index.value(), texture.tex_coord))
}

/// How many textures of something else than the colour a material has.
pub(super) fn other_textures(document: &Document, material: &Material<'_>) -> usize {
    let Some(json) = material.index().and_then(|index| document.as_json().materials.get(index)) else { return 0 };
    let others = [
        json.pbr_metallic_roughness.metallic_roughness_texture.is_some(),
        json.normal_texture.is_some(),
        json.occlusion_texture.is_some(),
        json.emissive_texture.is_some(),
    ];
    others.into_iter().filter(|there| *there).count()
}

/// Whether a material lets something through.
pub(super) fn is_transparent(document: &Document, material: &Material<'_>) -> bool {
    use gltf::material::AlphaMode::{Blend, Mask};
    let json = material.index().and_then(|index| document.as_json().materials.get(index));
    json.is_some_and(|json| matches!(json.alpha_mode, Valid(Blend | Mask)))
}

/// The image of a texture; `None` where there is no such texture or image.
pub(super) fn image(document: &Document, texture: usize) -> Option<Image<'_>> {
    let texture: Texture<'_> = document.textures().nth(texture)?;
    let source = document.as_json().textures.get(texture.index())?.source.value();
    document.images().nth(source)
}

/// Where the bytes of an image are.
pub(super) enum ImageSource<'a> {
    /// In this file, or in the address itself.
    Uri(&'a str),
    /// In the view of this number, which may lead nowhere.
    View(usize),
}

/// Where the bytes of an image are; `None` where the document does not say.
pub(super) fn source<'a>(document: &'a Document, image: &Image<'_>) -> Option<ImageSource<'a>> {
    let json = document.as_json().images.get(image.index())?;
    let view = json.buffer_view.map(|view| ImageSource::View(view.value()));
    json.uri.as_deref().map(ImageSource::Uri).or(view)
}

/// A primitive, and what it names.
pub(super) struct Primitive<'a> {
    document: &'a Document,
    primitive: gltf::Primitive<'a>,
    json: &'a json::mesh::Primitive,
}

/// The primitives of a mesh.
pub(super) fn primitives<'a>(document: &'a Document, mesh: &Mesh<'a>) -> impl Iterator<Item = Primitive<'a>> + use<'a> {
    let json = document.as_json().meshes.get(mesh.index()).map_or(&[][..], |mesh| &mesh.primitives);
    mesh.primitives().zip(json).map(move |(primitive, json)| Primitive { document, primitive, json })
}

impl<'a> Primitive<'a> {
    /// What the vertices make; `None` where that is no word of the specification.
    pub(super) fn mode(&self) -> Option<Mode> {
        matches!(self.json.mode, Valid(_)).then(|| self.primitive.mode())
    }

    /// Whether it has shapes to be blended with.
    pub(super) fn has_morph_targets(&self) -> bool {
        self.json.targets.as_ref().is_some_and(|targets| !targets.is_empty())
    }

    /// Whether the vertices have something of a kind.
    pub(super) fn has(&self, semantic: Semantic) -> bool {
        self.json.attributes.contains_key(&Valid(semantic))
    }

    /// What the vertices have of a kind.
    pub(super) fn attribute(&self, semantic: Semantic) -> Result<Option<Accessor<'a>>, FileProblem> {
        match self.json.attributes.get(&Valid(semantic.clone())) {
            Some(index) => accessor(self.document, index.value()).map(|_| self.primitive.get(&semantic)),
            None => Ok(None),
        }
    }

    /// The order of the vertices; `None` where they follow one another.
    pub(super) fn indices(&self) -> Result<Option<Accessor<'a>>, FileProblem> {
        match self.json.indices {
            Some(index) => accessor(self.document, index.value()).map(|_| self.primitive.indices()),
            None => Ok(None),
        }
    }

    /// The material, where one is named.
    pub(super) fn material(&self) -> Result<Option<Material<'a>>, FileProblem> {
        let Some(index) = self.json.material else { return Ok(None) };
        nth(self.document.materials(), index.value(), "materials").map(|_| Some(self.primitive.material()))
    }
}
