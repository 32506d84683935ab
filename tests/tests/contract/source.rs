//! The contract as `umat-abi/src` states it: the argument lists and the metadata.

use end_to_end_tests::workspace;
use proc_macro2::TokenStream;
use quote::quote;
use syn::parse::{Parse, ParseStream};
use syn::visit_mut::VisitMut;
use syn::{Attribute, Expr, Field, Ident, Item, Lit, Meta, Type};

/// One of UMAT, FRIC, UINTER.
pub struct EntryPoint {
    /// Lower case, without underscore.
    pub name: String,
    /// Description, line by line.
    pub doc: Vec<String>,
    /// Arguments in order, hidden lengths last.
    pub arguments: Vec<Argument>,
}

/// One argument of an entry point.
pub struct Argument {
    /// Lower case.
    pub name: String,
    /// `(ntens,ntens)`, or empty for a scalar.
    pub shape: String,
    /// Description.
    pub doc: String,
    /// Type in Rust.
    pub rust_type: Type,
}

impl Argument {
    fn new(field: &Field) -> Self {
        let doc = documentation(&field.attrs).join(" ");
        let shaped = doc.strip_prefix('`').and_then(|rest| rest.split_once('`'));
        let (shape, doc) = shaped.map_or((String::new(), doc.clone()), |(s, d)| (s.into(), d.trim_start().into()));
        let name = field.ident.as_ref().expect("fields have names").to_string();
        Self { name, shape, doc, rust_type: field.ty.clone() }
    }

    /// Returns whether it is a CHARACTER length, which Fortran compilers pass after the arguments.
    pub fn is_hidden_length(&self) -> bool {
        matches!(self.rust_type, Type::Path(_))
    }

    /// Returns whether the plugin may write it, and the type that it points to.
    pub fn pointer(&self) -> Option<(bool, String)> {
        match &self.rust_type {
            Type::Ptr(pointer) => {
                let Type::Path(target) = &*pointer.elem else { return None };
                let name = target.path.segments.last()?.ident.to_string();
                Some((pointer.mutability.is_some(), name))
            }
            _ => None,
        }
    }
}

/// The lines of `///` comments, rustdoc links reduced to their text.
fn documentation(attributes: &[Attribute]) -> Vec<String> {
    let line = |attribute: &Attribute| match &attribute.meta {
        Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
            Expr::Lit(literal) => match &literal.lit {
                Lit::Str(text) => Some(text.value().trim().replace("[`", "`").replace("`]", "`")),
                _ => None,
            },
            _ => None,
        },
        _ => None,
    };
    attributes.iter().filter_map(line).collect()
}

/// The body of `entry_point! { … }`.
struct Declaration {
    /// Attributes of the function's type, and of the arguments.
    attributes: [Vec<Attribute>; 2],
    fields: Vec<Argument>,
}

impl Parse for Declaration {
    fn parse(input: ParseStream<'_>) -> syn::Result<Self> {
        // ($) and the module, which the macro needs
        input.parse::<proc_macro2::Group>()?;
        input.parse::<Ident>()?;
        let of_type = input.call(Attribute::parse_outer)?;
        input.parse::<syn::Token![type]>()?;
        input.parse::<Ident>()?;
        input.parse::<syn::Token![,]>()?;
        input.parse::<Ident>()?;
        input.parse::<syn::Token![;]>()?;
        let of_arguments = input.call(Attribute::parse_outer)?;
        input.parse::<syn::Token![struct]>()?;
        input.parse::<Ident>()?;
        let body;
        syn::braced!(body in input);
        let fields = body.parse_terminated(Field::parse_named, syn::Token![,])?;
        Ok(Self { attributes: [of_type, of_arguments], fields: fields.iter().map(Argument::new).collect() })
    }
}

impl Declaration {
    /// The `entry_point!` of a file.
    fn of(name: &str) -> Self {
        let file = parse_source(&format!("{name}.rs"));
        let declaration = file.items.iter().find_map(|item| match item {
            Item::Macro(item) if item.mac.path.is_ident("entry_point") => Some(&item.mac),
            _ => None,
        });
        declaration.expect("an entry_point! in the file").parse_body().expect("the form of entry_point!")
    }
}

fn parse_source(file: &str) -> syn::File {
    let path = workspace("umat-abi/src").join(file);
    let text = std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

impl EntryPoint {
    /// UMAT, FRIC, UINTER.
    pub fn read_all() -> Vec<Self> {
        ["umat", "fric", "uinter"].map(Self::read).into()
    }

    fn read(name: &str) -> Self {
        let Declaration { attributes, fields } = Declaration::of(name);
        Self { name: name.into(), doc: documentation(&attributes.concat()), arguments: fields }
    }
}

/// The arguments of the function for many points.
pub fn batch_arguments() -> Vec<Argument> {
    Declaration::of("batch").fields
}

/// Returns the parts of `metadata.rs` that a C reader needs, under names that C can hold.
pub fn metadata() -> TokenStream {
    let mut output = TokenStream::new();
    for item in parse_source("metadata.rs").items {
        match item {
            Item::Const(item) if matches!(*item.ty, Type::Path(_)) => output.extend(constant("", item)),
            Item::Const(item) if item.ident == "PLUGIN_SYMBOL" => output.extend(plugin_function(&item.expr)),
            Item::Mod(module) => {
                let prefix = group_prefix(&module.ident.to_string());
                for item in module.content.into_iter().flat_map(|(_, items)| items) {
                    let Item::Const(item) = item else { continue };
                    output.extend(constant(&prefix, item));
                }
                if prefix == "BATCH_RESULT_" {
                    output.extend(batch_function());
                }
            }
            Item::Struct(mut item) if item.generics.params.is_empty() && is_repr_c(&item.attrs) => {
                let mut names = CNames::default();
                names.visit_item_struct_mut(&mut item);
                item.ident = c_name(&item.ident);
                output.extend(names.tables.iter().map(table));
                output.extend(quote!(#item));
            }
            Item::Type(mut item) => {
                CNames::default().visit_item_type_mut(&mut item);
                item.ident = c_name(&item.ident);
                output.extend(quote!(#item));
            }
            _ => {}
        }
    }
    output
}

/// `stress_states` → `STRESS_STATE_`.
fn group_prefix(module: &str) -> String {
    format!("{}_", module.strip_suffix('s').unwrap_or(module).to_uppercase())
}

/// Links to modules and constants become the names that C knows them by.
fn c_links(text: &str) -> String {
    let mut parts = text.split("[`");
    let mut result = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (target, rest) = part.split_once("`]").unwrap_or((part, ""));
        let is_module = target.chars().all(|c| c.is_ascii_lowercase() || c == '_');
        let name = if is_module { format!("{}…", group_prefix(target)) } else { target.to_owned() };
        result.push_str(&format!("PULLOUT_{name}{rest}"));
    }
    result
}

fn is_repr_c(attributes: &[Attribute]) -> bool {
    attributes
        .iter()
        .any(|a| matches!(&a.meta, Meta::List(list) if list.path.is_ident("repr") && list.tokens.to_string() == "C"))
}

/// `PULLOUT_<GROUP>_<NAME>`, in its value as well.
fn constant(prefix: &str, mut item: syn::ItemConst) -> TokenStream {
    struct Prefix<'a>(&'a str);
    impl VisitMut for Prefix<'_> {
        fn visit_ident_mut(&mut self, name: &mut Ident) {
            if name.to_string().chars().all(|c| c.is_ascii_uppercase() || c == '_') {
                *name = quote::format_ident!("PULLOUT_{}{}", self.0, name);
            }
        }
    }
    Prefix(prefix).visit_item_const_mut(&mut item);
    quote!(#item)
}

/// The function whose name `PLUGIN_SYMBOL` holds.
fn plugin_function(symbol: &Expr) -> TokenStream {
    let Expr::Lit(syn::ExprLit { lit: Lit::Str(symbol), .. }) = symbol else { panic!("the symbol is a literal") };
    let name = quote::format_ident!("{}", symbol.value());
    quote! {
        /// The description of the first law of a library; further ones follow by `next`.
        #[unsafe(no_mangle)]
        pub extern "C" fn #name() -> *const pullout_plugin {}
    }
}

/// The function for many points, and its type.
fn batch_function() -> TokenStream {
    let Declaration { attributes: [mut documentation, _], fields } = Declaration::of("batch");
    documentation.iter_mut().for_each(|line| CNames::default().visit_attribute_mut(line));
    let inputs = fields.iter().map(|Argument { name, rust_type, .. }| {
        let name = quote::format_ident!("{name}");
        quote!(#name: #rust_type)
    });
    let inputs = quote!(#(#inputs),*);
    let symbol = quote::format_ident!("{}", umat_abi::metadata::BATCH_SYMBOL);
    let pointer_doc = format!(" A pointer to `{symbol}`.");
    quote! {
        #(#documentation)*
        #[unsafe(no_mangle)]
        pub extern "C" fn #symbol(#inputs) {}
        #[doc = #pointer_doc]
        pub type pullout_umat_batch = unsafe extern "C" fn(#inputs);
    }
}

/// `StateVariable` → `pullout_state_variable`.
fn c_name(name: &Ident) -> Ident {
    let mut result = String::from("pullout");
    for letter in name.to_string().chars() {
        if letter.is_ascii_uppercase() {
            result.push('_');
        }
        result.push(letter.to_ascii_lowercase());
    }
    quote::format_ident!("{result}")
}

/// A view of a static array, for one type of element: C has no `Table<T>`.
fn table(element: &Ident) -> TokenStream {
    let name = quote::format_ident!("{element}_table");
    quote! {
        /// `count` elements, `stride` bytes from one to the next: read them by the stride, they may grow.
        #[repr(C)]
        pub struct #name {
            /// First element; NULL if `count` is 0.
            pub first: *const #element,
            /// Number of elements.
            pub count: u32,
            /// Bytes from one element to the next.
            pub stride: u32,
        }
    }
}

/// Gives the types of metadata their C names, and notes which tables occur.
#[derive(Default)]
struct CNames {
    tables: Vec<Ident>,
}

impl VisitMut for CNames {
    fn visit_lit_str_mut(&mut self, text: &mut syn::LitStr) {
        *text = syn::LitStr::new(&c_links(&text.value()), text.span());
    }

    fn visit_type_mut(&mut self, node: &mut Type) {
        let Type::Path(path) = node else { return syn::visit_mut::visit_type_mut(self, node) };
        let last = path.path.segments.last().expect("a type has a name");
        let renamed: Type = match last.ident.to_string().as_str() {
            "Text" => syn::parse_quote!(*const c_char),
            "Table" => {
                let syn::PathArguments::AngleBracketed(arguments) = &last.arguments else { panic!("Table<T>") };
                let Some(syn::GenericArgument::Type(Type::Path(element))) = arguments.args.first() else {
                    panic!("Table<T>")
                };
                let element = c_name(element.path.get_ident().expect("a plain name"));
                let name = quote::format_ident!("{element}_table");
                self.tables.push(element);
                syn::parse_quote!(#name)
            }
            name if name.starts_with(|c: char| c.is_ascii_uppercase()) => {
                let name = c_name(&last.ident);
                syn::parse_quote!(#name)
            }
            _ => return,
        };
        *node = renamed;
    }
}
