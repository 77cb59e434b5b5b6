"""Loads a fit that merlkit wrote with the readers of other projects.

fitted.py mitsuba FILE ID PAIRS OUT   pairs wo, wi as little-endian f32 -> f·cos θi of the BSDF, three channels
fitted.py materialx FILE              validates the document and generates shaders; prints the materials' names
fitted.py render FILE NAME OUT.png    draws a sphere with MaterialX's own renderer, which needs a display with OpenGL; prints
                                      the largest and the mean value of its pixels, 0 to 255
"""
import math
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


def read(path):
    import MaterialX as mx

    document, library = mx.createDocument(), mx.createDocument()
    mx.loadLibraries(mx.getDefaultDataLibraryFolders(), mx.getDefaultDataSearchPath(), library)
    mx.readFromXmlFile(document, path)
    document.importLibrary(library)
    valid, complaint = document.validate()
    if not valid:
        sys.exit(complaint)
    return document


def shader_context():
    import MaterialX as mx
    from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenShader

    generator = PyMaterialXGenGlsl.GlslShaderGenerator.create()
    context = PyMaterialXGenShader.GenContext(generator)
    context.registerSourceCodeSearchPath(mx.getDefaultDataSearchPath())
    return generator, context


def generate(path):
    from MaterialX import PyMaterialXGenShader

    document = read(path)
    generator, context = shader_context()
    for element in PyMaterialXGenShader.findRenderableElements(document):
        if generator.generate(element.getName(), element, context).getSourceCode("pixel"):
            print(element.getName())


def write_sphere(path, rows=64):
    """A sphere of radius 1 with normals and texture coordinates, as OBJ."""
    lines, columns = [], 2 * rows
    for i in range(rows + 1):
        for j in range(columns + 1):
            theta, phi = math.pi * i / rows, 2 * math.pi * j / columns
            point = "%f %f %f" % (
                math.sin(theta) * math.cos(phi),
                math.cos(theta),
                math.sin(theta) * math.sin(phi),
            )
            lines += [f"v {point}", f"vt {j / columns} {i / rows}", f"vn {point}"]
    for i in range(rows):
        for j in range(columns):
            a = i * (columns + 1) + j + 1
            for triangle in ((a, a + 1, a + columns + 2), (a, a + columns + 2, a + columns + 1)):
                lines.append("f " + " ".join(f"{v}/{v}/{v}" for v in triangle))
    with open(path, "w") as file:
        file.write("\n".join(lines) + "\n")


def render(path, name, out, side=256):
    import MaterialX as mx
    import numpy as np
    from MaterialX import PyMaterialXGenShader, PyMaterialXRender, PyMaterialXRenderGlsl

    document = read(path)
    sun = document.addNode("directional_light", "sun", "lightshader")
    sun.setInputValue("direction", mx.Vector3(0.5, -0.6, -0.7))
    sun.setInputValue("color", mx.Color3(1, 1, 1))
    sun.setInputValue("intensity", math.pi)
    generator, context = shader_context()
    options = context.getOptions()
    options.hwMaxActiveLightSources = 1
    options.hwSrgbEncodeOutput = True
    options.targetColorSpaceOverride = "lin_rec709"
    colors = PyMaterialXGenShader.DefaultColorManagementSystem.create(generator.getTarget())
    colors.loadLibrary(document)
    generator.setColorManagementSystem(colors)
    # Textures need the context of OpenGL that the renderer makes.
    size = (side, side, PyMaterialXRender.BaseType.UINT8)
    renderer = PyMaterialXRenderGlsl.GlslRenderer.create(*size)
    renderer.initialize()
    images = PyMaterialXRenderGlsl.GLTextureHandler.create(PyMaterialXRender.StbImageLoader.create())
    lights = PyMaterialXRender.LightHandler.create()
    lights.registerLights(document, [sun], context)
    lights.setLightSources([sun])
    black = PyMaterialXRender.createUniformImage(
        4, 2, 3, PyMaterialXRender.BaseType.FLOAT, mx.Color4(0, 0, 0, 1)
    )
    lights.setEnvRadianceMap(black)
    lights.setEnvIrradianceMap(black)
    renderer.setImageHandler(images)
    renderer.setLightHandler(lights)
    geometry = renderer.getGeometryHandler()
    geometry.addLoader(PyMaterialXRender.TinyObjLoader.create())
    write_sphere(out + ".obj")
    geometry.loadGeometry(mx.FilePath(out + ".obj"), False)
    camera, make = renderer.getCamera(), PyMaterialXRender.Camera
    eye, target, up = mx.Vector3(0, 0, 4), mx.Vector3(0, 0, 0), mx.Vector3(0, 1, 0)
    camera.setViewMatrix(make.createViewMatrix(eye, target, up))
    camera.setProjectionMatrix(make.createOrthographicMatrix(-1.1, 1.1, -1.1, 1.1, 0.1, 20))
    renderer.setCamera(camera)
    renderer.createProgram(generator.generate(name, document.getChild(name), context))
    renderer.validateInputs()
    renderer.render()
    picture = renderer.captureImage(None)
    images.saveImage(mx.FilePath(out), picture, True)
    values = [picture.getTexelColor(x, y) for x in range(0, side, 4) for y in range(0, side, 4)]
    values = 255 * np.array([[c[0], c[1], c[2]] for c in values])
    print(values.max(), values.mean())


if sys.argv[1] == "mitsuba":
    evaluate(*sys.argv[2:])
elif sys.argv[1] == "render":
    render(*sys.argv[2:])
else:
    generate(sys.argv[2])
