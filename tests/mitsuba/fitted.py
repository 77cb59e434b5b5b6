"""Loads a fit that merlkit wrote with the readers of other projects.

fitted.py mitsuba FILE ID PAIRS OUT   pairs wo, wi as little-endian f32 -> f·cos θi of the BSDF, three channels
fitted.py materialx FILE              validates the document and generates shaders; prints the materials' names
"""
import sys
import xml.etree.ElementTree as ElementTree


def evaluate(path, name, given, out):
    import mitsuba as mi
    import numpy as np

    mi.set_variant("scalar_rgb")
    mi.load_file(path)
    # The scene has no shapes, and a BSDF that none refers to can't be asked for, so its element is loaded by itself.
    element = next(e for e in ElementTree.parse(path).getroot() if e.get("id") == name)
    element.set("version", "3.0.0")
    material = mi.load_string(ElementTree.tostring(element, encoding="unicode"))
    context, surface = mi.BSDFContext(), mi.SurfaceInteraction3f()
    rows = []
    for pair in np.fromfile(given, "<f4").reshape(-1, 6):
        surface.wi = mi.Vector3f(*map(float, pair[:3]))
        rows.append(list(material.eval(context, surface, mi.Vector3f(*map(float, pair[3:])))))
    np.array(rows).astype("<f4").tofile(out)


def generate(path):
    import MaterialX as mx
    from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenShader

    document, library = mx.createDocument(), mx.createDocument()
    folders, search = mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath()
    mx.loadLibraries(folders, search, library)
    mx.readFromXmlFile(document, path)
    document.importLibrary(library)
    valid, complaint = document.validate()
    if not valid:
        sys.exit(complaint)
    generator = PyMaterialXGenGlsl.GlslShaderGenerator.create()
    context = PyMaterialXGenShader.GenContext(generator)
    context.registerSourceCodeSearchPath(search)
    for element in PyMaterialXGenShader.findRenderableElements(document):
        if generator.generate(element.getName(), element, context).getSourceCode("pixel"):
            print(element.getName())


if sys.argv[1] == "mitsuba":
    evaluate(*sys.argv[2:])
else:
    generate(sys.argv[2])
