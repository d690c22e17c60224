//! The rules of the specification, each with a name that stays.

/// Declares the rules: variant, message id, clause, and what must hold.
macro_rules! rules {
    ($($name:ident $id:literal $clause:literal $text:literal)*) => {
        /// A rule of `spec/lfslab-1.0.md` that a file can break.
        ///
        /// The message id names the rule for programs and does not change between versions of this crate.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Rule {
            $(#[doc = $text] $name,)*
        }

        impl Rule {
            /// All rules, in the order of the specification.
            pub const ALL: &[Self] = &[$(Self::$name),*];

            /// The message id, such as `entry.offset`.
            #[must_use]
            pub const fn id(self) -> &'static str {
                match self { $(Self::$name => $id,)* }
            }

            /// The clause of the specification, such as `§4.5`.
            #[must_use]
            pub const fn clause(self) -> &'static str {
                match self { $(Self::$name => $clause,)* }
            }

            /// What must hold, in a sentence.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self { $(Self::$name => $text,)* }
            }
        }
    };
}

rules! {
    Overflow "file.overflow" "§2.2" "Lengths and counts fit in 64 bits."
    Magic "header.magic" "§3.1" "The file begins with the magic, undamaged."
    Version "header.version" "§3.2" "The major version is 1."
    Truncated "header.truncated" "§3.3" "The file is as long as its header says, not shorter."
    FileLength "header.file-length" "§3.3" "The file is as long as its header says, not longer."
    DirectoryOffset "header.directory-offset" "§3.4" "The directory begins at byte 64."
    EntryCount "header.entry-count" "§3.5" "There are 2 to 65,536 entries, which end within the file."
    HeaderReserved "header.reserved" "§3.6" "Reserved bytes of the header are zero."
    DirectoryChecksum "header.directory-checksum" "§3.7" "The checksum of the directory is right."
    HeaderChecksum "header.checksum" "§3.8" "The checksum of the header is right."
    Tag "entry.tag" "§4.1" "A tag is four ASCII letters or digits."
    Flags "entry.flags" "§4.2" "Flags are those of the tag, or not both set."
    Critical "entry.critical" "§4.2" "A critical chunk has a tag that the reader knows."
    Packing "entry.packing" "§4.3" "A chunk is packed in a way that its kind allows."
    Subject "entry.subject" "§4.4" "Slab and tile are zero or name a slab, as the tag asks."
    Offset "entry.offset" "§4.5" "Each payload begins at the first multiple of 64 after what comes before it."
    Padding "file.padding" "§4.5" "Padding is zero."
    Tail "file.tail" "§4.5" "The file ends where the last payload ends."
    StoredLength "entry.stored-length" "§4.6" "A payload is not empty and ends within the file."
    RawLength "entry.raw-length" "§4.7" "The raw length is the stored length, or what geometry and windows make it."
    Checksum "entry.checksum" "§4.8" "The checksum of a chunk is right."
    EntryReserved "entry.reserved" "§4.9" "Reserved bytes of an entry are zero."
    Order "entry.order" "§4.10" "Entries are in order, none twice, none missing."
    Cell "geom.cell" "§5.1" "The cell's centre is finite, its half extents are positive."
    SlabCount "geom.slab-count" "§5.2" "There are one to six slabs."
    Face "geom.face" "§5.3" "A face is 0 to 5."
    FaceOrder "geom.face-order" "§5.3" "Faces are in ascending order, none twice."
    Encoding "geom.encoding" "§5.4" "The reader knows the texel encoding."
    Transfer "geom.transfer" "§5.5" "The transfer function is the one of the texel encoding."
    Plane "geom.plane" "§5.6" "The camera plane is finite."
    Axis "geom.axis" "§5.7" "An axis has a finite first sample, a positive step, 1 to 65,536 samples and a finite last one."
    FocalDepth "geom.focal-depth" "§5.8" "The focal depth is positive or all bits are zero; disparities are finite."
    Tiling "geom.tiling" "§5.9" "A tile holds at least one camera along each axis and no more than there are; sizes fit."
    GeometryReserved "geom.reserved" "§5.10" "Reserved bytes of a slab's record are zero."
    GeometryLength "geom.length" "§5.11" "The geometry is as long as its slabs ask for."
    CropLength "crop.length" "§6.1" "There is one record for each column and each row of cameras."
    CropWindow "crop.window" "§6.1" "A window lies within the image; an empty one begins at 0."
    CropNothing "crop.nothing" "§6.1" "At least one block is left out."
    MaskLength "mask.length" "§6.2" "There is one bit for each camera."
    MaskBits "mask.bits" "§6.2" "Bits beyond the last camera and of cameras with an empty window are 0."
    MaskNothing "mask.nothing" "§6.2" "At least one camera with a window is left out."
    NoCamera "slab.no-camera" "§6.3" "Every slab stores at least one camera."
    Padded "tile.padding" "§7.2" "In place of cameras that are not stored there are zeros."
    Opaque "tile.opaque" "§7.3" "BC1 blocks are opaque."
    Alpha "tile.alpha" "§7.4" "Alpha is 255."
    Frame "tile.zstd" "§7.5" "A packed tile is one whole zstd frame with its size and a window of at most 8 MiB."
    TileCodec "tile.codec" "§7.8" "What a tile in the tile codec unpacks to are the streams of its blocks."
    Finite "tile.finite" "§7.9" "Half-float texels are finite."
    MetadataLength "meta.length" "§8" "Metadata is at most 1 MiB long."
    MetadataCount "meta.count" "§8.1" "Metadata has at least one entry."
    MetadataOrder "meta.order" "§8.2" "Keys are in ascending order, none twice; the payload ends with the last."
    MetadataKey "meta.key" "§8.3" "A key is 1 to 64 of the characters a-z, 0-9, '.', '_' and '-'."
    MetadataValue "meta.value" "§8.4" "A value is at most 64 KiB of UTF-8 without control characters but tab and line feed."
}
