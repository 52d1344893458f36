//! What one mesh is asked without a scene: rays, nearest points, winding numbers and ways out of itself, by a search tree over
//! its triangles; and the contacts of two meshes, or of one with itself.

mod closest;
mod octree;
mod own_exits;
mod pairs;
mod rays;

pub use closest::*;
pub use octree::*;
pub use own_exits::*;
pub use pairs::*;
pub use rays::*;
